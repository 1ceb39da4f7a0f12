//! E901–: parts of the language that are not supported yet.

super::entries! {
    E902 form_not_supported(what) "a form that is not supported yet"
        "not supported yet: {what}" "" "leave it out, or write the motion with what LANGUAGE.md, section 3, lists"
        "The language defines this form, and this version does not implement it. It is refused rather than ignored.";
}
