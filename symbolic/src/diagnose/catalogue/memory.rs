//! E270–: held values, what sets them, and when.

super::entries! {
    E270 memory_misplaced(name, context) "a held value where it may not be"
        "`{name}` is held between events, and {context} may not depend on it" "" "a force, a torque, a potential, an input that moves no body, the rate of a state or an output may contain it"
        "A held value jumps when an event sets it. Places, masses, velocities and constraints that contain it would jump too, with infinite forces; and what is of parameters only is computed once.";
    E271 cannot_set(name, found, help) "something that an event cannot set"
        "`{name}` is {found}, which an event cannot set" "" "{help}"
        "An event sets what `memory` holds, and states of first order. Coordinates and their rates change by forces and impacts; parameters stay as they are along a run.";
    E272 unclear_trigger(name) "an event that does not say when it happens"
        "the event `{name}` needs one of `when`, `every` and `on_set`" "" "`when: e` happens where e passes through zero, `every: 5 ms` again and again, `on_set: NAME` when that was set"
        "An event happens for one reason; two reasons are two events, which may do the same.";
    E273 input_jumps(name, held) "an input that holds a value and moves a body"
        "the input `{name}` contains the held value `{held}`, and bodies follow its place or its rate" "" "let the held value act as a force: a spring and a damper towards it, or a motor"
        "Where a held value is set the input jumps, and what it moves would have to jump with it, by an infinite force.";
    E274 key_of_other_trigger(key, of) "a key that belongs to another kind of event"
        "`{key}` is for events with `{of}`" "" "leave `{key}` out"
        "`direction` says in which direction a function passes through zero, `from` when the first tick comes.";
    E275 column_taken(name, what) "an output with the name of what is written down by itself"
        "`{name}` is {what}, which is written down by itself" "" "leave this output out, or give it another name"
        "Time, coordinates, states and held values are columns of tables, charts and JSON under their own names; two columns of one name with two values cannot be told apart. An output `x: x` of a coordinate is allowed.";
    E276 integral_of_memory(name) "a held value in an integral"
        "`{name}` contains a held value, and an integral may not" "" "take it out of the integral where it is a factor; else compute the integral as a state: `rate`"
        "An integral is computed by a rule that was tried at the values that its integrand may have, and a held value may have any.";
}
