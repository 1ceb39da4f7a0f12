//! E501–: what deriving and testing at random states finds.

super::entries! {
    E501 not_conserved(name, by, state) "a quantity that is not conserved"
        "`{name}` is not conserved: its rate is {by}" "claimed to be conserved" "at {state}"
        "The rate of everything in `conserved` must vanish when the model's accelerations are put in.";
    E502 check_fails(name, by, state) "a check that does not hold"
        "the check `{name}` does not hold: its sides differ by {by}" "claimed to hold" "at {state}"
        "Everything in `checks` must hold in all states.";
    E503 derivations_disagree(what, by, state) "two derivations that disagree"
        "two derivations of {what} differ by {by}" "" "at {state}"
        "Lagrange's equations and the virtual power of the bodies must give the same accelerations, and constraints differentiated forward and in reverse the same rows. If the file is right this is a fault of the program.";
    E504 too_few_states(found, wanted, help) "too few states to test at"
        "only {found} of {wanted} random states are usable" "" "{help}"
        "States that are not finite, fall on a discontinuity, or lie outside of `sample` where they meet the constraints, are drawn again, up to a limit.";
    E505 singular_mass(rank, names, state) "coordinates that are redundant, or move no mass"
        "the mass matrix has rank {rank} in every state tried" "some motion of {names} moves no mass" "leave out a coordinate that the others determine, or give what it moves a mass; tried at {state}"
        "Accelerations do not exist where the mass matrix is singular. A particle in the plane has two coordinates; a third one that also moves it leaves a combination that moves nothing.";
    E506 balances_disagree(system, coordinate, balances, lagrange, worst, help) "a system of balances that disagrees"
        "`{system}` gives {coordinate} = {balances}, Lagrange's equations give {lagrange}" "{worst}" "{help}"
        "Momentum balance and Lagrange's equations are two derivations of one motion; where they differ one of them is wrong.";
    E507 balances_singular(system, state) "a system of balances that is singular"
        "`{system}` does not determine the accelerations" "singular at every state tried, such as {state}" "a balance may follow from others, or be identically zero: choose another point, or another direction with `along`"
        "A second derivation must be complete: its equations have to be independent.";
    E508 empty_balance(label, help) "a balance that says nothing"
        "{label} is identically zero" "" "{help}"
        "An equation 0 = 0 determines nothing.";
    E509 changed_by(name, causes, help) "a quantity that some force changes"
        "`{name}` is not conserved: {causes}" "claimed to be conserved" "{help}"
        "The forces named make up all of the rate of what should be conserved. For `energy` that is their power: a force that has a potential belongs in `potential_energy` (or is a spring, or gravity), and one that has none takes part in no energy that is conserved.";
    E510 nonlinear_balance(label) "a balance that is not linear in its unknowns"
        "{label} is not linear in the accelerations and reactions" "" "an acceleration or reaction may stand in sums, times anything of the state"
        "Every balance of mechanics is linear in accelerations and reactions: forces and inertia add.";
    E511 reactions_disagree(name, first, here, second, there, state) "a reaction with two values"
        "`{name}` is {here} in `{first}` and {there} in `{second}`" "both give the same motion" "at {state}; a sign or a place of `{name}` is wrong in one of the two"
        "Systems that name the same reaction must give it the same value. In a written-out `equation` a reaction can stand with a wrong sign without changing the motion.";
    E512 balance_violated(label, worst, help) "a balance that the motion violates"
        "{label} does not hold" "{worst}" "{help}"
        "With the accelerations of Lagrange's equations and whatever values its reactions may take, this balance is not 0 = 0.";
    E513 jumps(name, by, state) "a quantity that jumps where something switches"
        "`{name}` is not conserved: it jumps from {by}" "claimed to be conserved" "at {state}"
        "Positions and speeds are continuous where a `step`, `sign` or the like changes its value; what is conserved must be so too.";
    E514 constraints_not_met(names, tried) "constraints that no state meets"
        "no state was found that meets {names}" "" "lengths may not close: give values with which they do, or a `start` or `guess` near a place where all hold; {tried} places were tried"
        "Derivations are compared at states that meet the constraints.";
    W515 redundant(names, phase, help, sharing) "a constraint that follows from others"
        "{names} follows from the constraints before it{phase}" "redundant" "{help}; the run goes on with it, but the reactions of {sharing} are not unique"
        "Constraints that depend on each other hold the same motions as fewer of them; their reactions are not unique.";
    E516 impulse_violated(label, by, state) "a balance that an impact violates"
        "{label} does not hold integrated over the instant of an impact" "off by {by} of its terms" "at {state}; is a reaction that pushes there missing in the system, or in the wrong place?"
        "Where constraints are entered or struck, M Δq' = Jᵀ P: balances of force and moment must say the same of the momenta, with impulses of the reactions that they name.";
    E517 reaction_against_constraint(label, by, state, help) "a reaction that is not the constraint's force"
        "{label} does not hold with the multiplier of Lagrange's equations for `reaction(...)`" "off by {by} of its terms" "at {state}; {help}"
        "The multiplier of a constraint follows from Lagrange's equations; an equation that says which named reaction it is must hold with this value.";
    E518 reaction_against_bodies(name, here, label, there, state) "a reaction that is not what its body's balance makes it"
        "`{name}` is {here} by {label}, and {there} by force and moment on the bodies" "accelerations do not depend on it" "at {state}; correct the equation, or take a balance of the body on which `{name}` acts for it, such as `force: {{of: ..., along: ...}}`; if another reaction acts in the same direction, name it too"
        "Where only one written-out equation says what a reaction is, the motion does not tell whether it is right. Where the named reactions can be all that holds the bodies, force and moment on these tell, with the accelerations of Lagrange's equations.";
    E519 impact_elsewhere(event, constraint, value, state) "an impact along a constraint that is not touched"
        "the impact of `{event}` acts along `{constraint}`, which is {value} where the event happens" "the constraint must be 0 there" "at {state}; let `when` be what `{constraint}` says is 0, or name in `along` the constraint that is 0 there"
        "An impact is an impulse of what a constraint stands for, a floor or a wall: it acts where that is touched, where the constraint is zero.";
    E520 length_matters(rotation, what, state) "a rotation whose length matters"
        "{what} depends on the length of the quaternion of `{rotation}`" "" "a rotation has a direction only: something contains its four numbers by themselves; at {state}"
        "A rotation is kept as a quaternion of any length, R(q)/|q|²; nothing may change where q and q' are multiplied by one factor.";
    E521 shift_matters(name, what, by, state) "a shift along which something changes"
        "{what} depends on `{name}`: it changes by {by}" "cannot differ freely" "leave it out; a coordinate that is whole turns more goes into `turn`; at {state}"
        "A motion goes on alike from another place where nothing depends on the place.";
    E522 no_symmetry(what, by, state) "an exchange or mirror that changes the motion"
        "{what} is not what it was: it differs by {by}" "not a symmetry" "at {state}; the motion must go on from the image as from the start: F(S q, S q', S q'') = S F(q, q', q''), with the parameters of the motion"
        "The image of a motion under an exchange or mirror is a motion only where equations, constraints and events are the same ones for it; with time reversed speeds change their signs too.";
    E523 not_a_period(period, what, by, state) "a period that is none"
        "after {period} s {what} is not what it was: it differs by {by}" "not a period of what acts" "at {state}; write it with the frequency of the inputs, `2*pi/w`, in all its digits"
        "A mechanism that depends on time goes on as it began only after a time in which all of that repeats itself.";
    E524 too_few_states_when(name) "a condition at which nothing is defined"
        "too few random states are usable where the condition of `{name}` holds" "" "where the model divides by what is 0 there, say what it is for with a small number, or leave `when` out"
        "What is claimed under a condition is tested at states with the parameters that it names; where accelerations or the claim are not finite nothing can be tested.";
    E525 constraint_without_slope(names) "a constraint that holds and has no slope"
        "{names} holds where the scene starts, but its slopes vanish there" "" "write what is squared instead of its square: `y - x`, not `(y - x)^2`"
        "A constraint acts along its slopes, ∂c/∂q. Where all of them are 0 it has no direction to push in, and holds nothing.";
}
