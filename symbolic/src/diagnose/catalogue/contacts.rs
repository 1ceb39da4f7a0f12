//! E278–: friction that sticks and contacts that open by themselves.

super::entries! {
    E278 phases_beside_contacts() "phases beside friction or contacts"
        "`friction` and `contacts` make the phases of a file, which cannot have others beside them yet" "" "leave `phases` out; or write all phases by hand, with `constraints` and `events`"
        "Every combination of what contacts do is a phase: each sticks, slips or is open. How such phases combine with those of a file is not settled.";
    E279 too_many_contacts(most) "too many combinations of what contacts do"
        "the contacts of this file have more than {most} combinations of sticking, slipping and opening" "" "take contacts that never open, or never rub, as constraints; or leave friction out where it decides nothing"
        "A contact with friction is open, sticks, or slips in one of two directions: four of them have 256 combinations, each of which is a phase that is derived and judged. In space it is open, sticks or slides: five of them have 243.";
    E280 no_friction_there(name) "the friction of a contact that has none"
        "`{name}` has no friction, so `{name}.friction` is nothing" "" "`reaction({name})` is the force across it; `friction: mu` lets it rub"
        "`reaction(c.friction)` is the force along a contact c that sticks, in space a vector.";
}
