//! E901–: parts of the language that are not supported yet.

super::entries! {
    E901 key_not_supported(key, section) "a key that is not supported yet"
        "not supported yet: `{key}` in {section}" "" "the model is not the same without it: describe the mechanism in another way, or wait for a later version"
        "The language defines this key, and this version does not implement it. It is refused rather than ignored.";
    E902 form_not_supported(what) "a form that is not supported yet"
        "not supported yet: {what}" "" "wait for a later version"
        "The language defines this form, and this version does not implement it. It is refused rather than ignored.";
}
