//! E278–: friction that sticks and contacts that open by themselves.

super::entries! {
    E278 phases_beside_contacts() "phases beside friction or contacts"
        "`friction` and `contacts` make the phases of a file, which cannot have others beside them yet" "" "leave `phases` out; or write all phases by hand, with `constraints` and `events`"
        "Every combination of what contacts do is a phase: each sticks, slips or is open. How such phases combine with those of a file is not settled.";
    E279 too_many_contacts(count, most) "too many contacts"
        "this file has {count} contacts and frictions, of which {most} can be derived and judged" "" "leave out pairs that never meet; or take contacts that never open, or never rub, as constraints"
        "Where contacts have up to 256 combinations of sticking, slipping and opening each of these is a phase. Of more, which only `--method moreau` runs, what each contact does by itself is derived and judged, in time that grows faster than their number.";
    E280 no_friction_there(name) "the friction of a contact that has none"
        "`{name}` has no friction, so `{name}.friction` is nothing" "" "`reaction({name})` is the force across it; `friction: mu` lets it rub"
        "`reaction(c.friction)` is the force along a contact c that sticks, in space a vector.";
}
