//! E260–: states of first order.

super::entries! {
    E260 state_misplaced(name, context) "a state where it may not be"
        "`{name}` is a state of first order, and {context} may not depend on one" "" "what moves by a law of first order is a coordinate: declare it in `coordinates` and state its rate as a constraint, `x' - e = 0`; a force or a potential may contain a state"
        "Positions and constraints are differentiated twice, and the second rate of a state would contain accelerations. Forces, torques, potentials, rates of other states, outputs, events and drawings may contain states.";
    E261 state_rate_misplaced(name, context) "the rate of a state where it may not be"
        "`{name}` is the rate of a state, and {context} may not contain one" "" "write out its right-hand side where that has no velocities"
        "The rate of a state stands for its right-hand side, which may contain velocities.";
    E262 second_rate(name) "a second rate of a state"
        "`{name}` is not known: a state of first order has one rate" "" "write out the right-hand side of its rate e and use `rate(e)` in `outputs`, `checks` or `events`"
        "The second rate of a state is the rate of its right-hand side, which may contain accelerations.";
    E263 state_without_law(name) "a state without a law"
        "the state `{name}` needs `rate` or `equation`, and one of them only" "" "write `{name}: {{unit: U, rate: e}}`, or `{{unit: U, equation: \"a*{name}' + b = c\"}}`"
        "A state changes at a rate that the file says.";
    E264 not_affine_in_rates(name) "an equation that is not affine in the rates of states"
        "the equation of `{name}` is not affine in the rates of states" "" "solve it for the rate by hand and state that as `rate`"
        "Equations for rates are solved together when the file compiles, as linear equations.";
    E265 undetermined_rate(name) "rates of states that their equations leave open"
        "the rate of `{name}` does not follow from the equations of the states" "" "each equation contains the rate of its state, and none may follow from the others; what has no rate is a definition (`define`)"
        "Equations for rates are solved together when the file compiles; the matrix of these is singular.";
    E266 rate_of_solved(words) "an acceleration or reaction in the rate of a state"
        "`{words}` contains an acceleration or a reaction, and the rate of a state may not" "" "give what pushes a spring and a damper, whose force is known from positions and speeds, or make an output of it"
        "Accelerations and reactions are solved for when the forces are known, which may contain the rates of states.";
}
