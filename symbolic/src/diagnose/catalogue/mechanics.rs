//! E401–: coordinates, bodies, forces, scenes.  `W` marks a warning.

super::entries! {
    E401 no_coordinates() "no coordinates"
        "the model has no coordinates" "" "declare at least one, `coordinates: {{x: m}}`"
        "A model moves in its generalized coordinates.";
    E402 no_mass(name) "a coordinate that carries no mass"
        "the coordinate `{name}` carries no mass" "nothing resists its acceleration" "give a body that moves with `{name}` a mass or inertia"
        "The mass matrix is singular at every state, so accelerations do not exist.";
    E403 shared_point(load, point, bodies, first, difference) "a force at a hinge that does not say on which body"
        "`{load}` acts at `{point}`, which {bodies} carry, and it matters which of them takes it" "name the body" "write `{{on: {first}, at: {point}}}` or another of them: {difference}"
        "At a hinge the bodies move alike, but a force on one of them or on the other makes a different force of the hinge. Where no acceleration and no named reaction differs, the body need not be named.";
    E404 no_body(point) "a force at a point that no body carries"
        "no body carries the point `{point}`" "name the body" "write `{{on: BODY, at: {point}, …}}`"
        "A force acts on the material of a body in which the point is at rest.";
    E405 at_on_particle(name) "a force on a particle at another place"
        "the particle `{name}` takes forces at its own position only" "" "remove `at`, or give the body an `angle` (in space a `frame`)"
        "A particle has no extent.";
    E406 needs_orientation(name, context) "a body without orientation"
        "`{name}` has no angle, and {context} needs one" "" "give `{name}` an `angle` (in space a `frame`)"
        "A particle cannot take a torque and has no angular velocity.";
    E407 incomplete_body(name, given, missing) "an incomplete rigid body"
        "the body `{name}` has `{given}` and no `{missing}`" "" "give `{missing}` too"
        "A planar rigid body needs `inertia` and `angle`, one in space `inertia` and `frame`; a particle has neither.";
    W408 does_nothing(name) "an entry that does nothing"
        "`{name}` acts on the ground only" "has no effect" ""
        "A force on the ground does not change the motion.";
    E409 derived_parameter(name, free) "setting a derived parameter"
        "`{name}` is computed from other parameters and cannot be set" "" "set one of {free}"
        "A parameter whose value names others is recomputed whenever they change.";
    E410 unknown_start(name, help) "a start of something that is no coordinate"
        "`{name}` is not a coordinate or velocity" "" "{help}"
        "`start` gives values to coordinates `x` and velocities `x'`.";
    E411 value_out_of_range(context, wanted, found) "a value out of its range"
        "{context} must be {wanted}, this is {found}" "" ""
        "Tolerances are positive, times and masses are not negative.";
    E413 same_ends(name) "a spring or damper between one point and itself"
        "both ends of `{name}` are the same point" "" ""
        "It has no length and no direction.";
    E414 unequal_counts(system, equations, unknowns, more) "balances that do not determine the motion"
        "`{system}` has {equations} for {unknowns}" "" "choose balances that eliminate the other reactions, or name more of them{more}"
        "Equations and unknowns of a system of balances must be equal in number; a force balance in the plane is two equations, a moment balance one. The constraints that act in the phase of the system count as equations, one for each component, and a `reaction(c)` in its equations or in forces on its bodies is one more unknown.";
    E415 raw_beside_balances(key) "raw energies beside momentum balances"
        "`{key}` beside balances of forces, moments or power" "on which body does this act?" "say it with `springs`, `dampers`, `forces` or `torques`, which know their bodies"
        "Momentum balances see bodies, gravity, springs, dampers, forces, torques and reactions, nothing else.";
    E416 energy_with_time() "an energy balance with explicit time"
        "the energies contain time, or a mass that changes, so that something does work that this balance does not see" "" "use `power`"
        "`energy` states that kinetic plus potential energy changes by the power of what has no potential.";
    E417 too_many_coordinates(limit) "more coordinates than can be derived"
        "a model may have {limit} coordinates" "one too many" "make families smaller"
        "Deriving keeps the equations of all coordinates at once; the limit bounds time and memory.";
    E418 counted_twice(names, key, terms) "a force that an energy counts too"
        "{names} is in `{key}` too, as {terms}" "counted twice" "keep one of the two; if both are meant, write one with twice the factor"
        "Q + ∂V/∂q = 0 (for `dissipation` Q + ∂D/∂q' = 0) at all states tried: the entry and these terms are one and the same force, which would act twice.";
    W419 repeats(name, other) "a force that another entry gives too"
        "{name} does what {other} does" "acts once more" "remove one of the two unless both are meant"
        "Two entries have the same generalized force at all states tried, such as a weight that is written out beside `gravity`.";
    W420 no_inertia(name) "a body that turns and has no inertia"
        "`{name}` has mass and turns, and has no `inertia`" "taken as 0" "give `inertia` about its centre of mass; `inertia: 0` (in space `[0, 0, 0]`) if it is a point that carries a frame"
        "A body with an angle or a frame whose inertia is left out resists no turning: its mass is in one point.";
    E421 too_many_switches(limit) "more discontinuities than can be located"
        "the equations have more than {limit} discontinuities" "here at the latest" "use smaller sizes, or one function in the place of many steps"
        "Every `abs`, `sign`, `step`, `min` and `max` of what moves is followed while a run goes on; the limit bounds time and memory.";
    E422 too_many_coupled(limit) "more coordinates and constraints that depend on each other than can be solved for"
        "masses and constraints couple more than {limit} coordinates and constraints with each other" "one too many" "make families smaller, or choose coordinates that move one body each, or that need no constraints"
        "Accelerations of coordinates that move the same bodies or stand in the same constraint depend on each other, directly or by way of others, and on the constraints' forces; solving for n of them takes n^3 operations.";
    E423 constraint_without_motion(name) "a constraint that constrains nothing"
        "the constraint `{name}` does not depend on the motion" "its derivative by every coordinate (or velocity) vanishes" "a constraint is an expression of coordinates or velocities that is to vanish; of a vector the component along e is `dot(…, e)`"
        "What is constant or a function of time alone is never 0, or at single instants only: no force can change that. A row that is 0 whatever the motion is a warning.";
    E424 not_affine(name) "a constraint that is not affine in the velocities"
        "the constraint `{name}` is not affine in the velocities" "a velocity stands in a product with another, in a power or in a function" "velocities may stand in sums, times anything of coordinates and time: `x' - R*phi'`; a speed that is to be kept, `x'^2 + y'^2 = v^2`, is no constraint that forces of reaction can hold; what has a rate and no inertia, `z' = f`, is a state: `states: {{z: {{rate: f}}}}`"
        "A constraint with velocities is A(q, t) q' + b(q, t) = 0, and its force is along the rows of A.";
    E425 input_rate_in_constraint(name) "the rate of an input in a constraint without velocities"
        "the constraint `{name}` contains the rate of an input and no velocity" "its second derivative needs a third one of the input" "declare the rate as an input of its own, and use that"
        "A constraint without velocities is differentiated twice, and an input is known with two derivatives.";
    E426 idle_guess() "a guess where nothing is searched"
        "no constraint acts in the phase in which this scene starts, and it has no `also`" "nothing is left to guess" "write the values into `start`; what it does not name is 0"
        "`guess` is where the search for a consistent start begins, and picks its branch. Without constraints and `also` there is nothing to search.";
    E427 unknown_held(name, help) "something held at the start that is not watched"
        "`{name}` is neither in `conserved` nor in `outputs`" "not declared" "{help}"
        "`also` gives values to quantities that the file names in `conserved` or `outputs`; coordinates and velocities are held by `start`.";
    E428 cannot_hold(name, why, help) "something that a start cannot be made to give"
        "`also` cannot hold `{name}`: {why}" "" "{help}"
        "`also` adds equations on coordinates and velocities to those of the constraints.";
    E429 impact_along_velocity(name) "an impact along a velocity constraint"
        "an impact needs a constraint on coordinates, and `{name}` contains velocities" "" "name a constraint without velocities, such as `y - R`"
        "An impact reverses the rate of a constraint that was closing; a constraint on velocities has no rate of its own. Going to a phase in which it acts is the plastic impact.";
    E430 impact_along_active(name) "an impact along a constraint that acts"
        "`{name}` acts in every phase in which this event counts, so that nothing can hit it" "active here" "let the event count in a phase that leaves `{name}` out: `phases: {{flight: [], contact: [{name}]}}` and `phase: flight`"
        "An impact is along a constraint that is not active: what holds already does not bounce.";
    E431 energy_with_driven_constraint(name) "an energy balance with a constraint that does work"
        "the constraint `{name}` moves by itself and does work that this balance does not see" "" "use `power`"
        "`energy` states that kinetic plus potential energy changes by the power of what has no potential; the reaction of a constraint that contains time, an input or a given velocity has a power too.";
    W432 idle_constraint(name) "a constraint that never acts"
        "the constraint `{name}` acts in no phase and in no impact" "has no effect" "list it in `phases`"
        "With `phases` a constraint acts in those that list it.";
    E433 nothing_has_mass() "a file with constraints in which nothing has mass"
        "no coordinate of this file moves a mass" "" "give what moves a mass, with a body or by `kinetic_energy`; where constraints alone determine the motion every mass gives the same one"
        "The forces of constraints follow from what they accelerate; where that is nothing the equations are singular at every state.";
    W434 driving_friction(name, power, state) "friction that drives"
        "{name} acts along the sliding, not against it: its power is {power}" "made of a reaction, and drives" "at {state}; `reaction(c)` is positive where it pushes towards growing c, so that of a floor written `-y` is negative: write the constraint as `y`, or change the sign of the force; where the reaction has either sign make a phase for each"
        "Friction is made of the reaction of a constraint and opposes the sliding. What is warned of pushes along it somewhere on the motion of a scene, or at all states at which it acts.";
    E435 angle_in_space() "an angle in a model in space"
        "in space an angle needs an axis to turn about" "" "name the axis: a frame `B: {{rotate: [z, theta]}}`, and `frame: B` in the body"
        "A frame in space is turned by `rotate`: about one axis, or about several in turn.";
    E436 not_a_turn(found) "a turn that is none"
        "`rotate` is a turn `[axis, angle]` or a list of them, this is {found}" "" "write `rotate: [z, psi]`, or `rotate: [[z, psi], [x, theta]]`; an axis is x, y, z or a direction `[a, b, c]` that is fixed in the frame"
        "Each turn is about an axis of the frame as it is turned already.";
    E437 not_moments(found) "inertia in space that is none"
        "the inertia of a body in space is three principal moments or a tensor of three rows, this is {found}" "" "write `[Ix, Iy, Iz]`, or `[[Ixx, Ixy, Ixz], [Ixy, Iyy, Iyz], [Ixz, Iyz, Izz]]`; where all moments are equal `[I, I, I]`"
        "Moments are about the centre of mass, along the axes of the body's frame; Ixy = -∫ x y dm.";
    E438 unsymmetric_inertia(name, element, other) "a tensor of inertia that is not symmetric"
        "the tensor of `{name}` is not symmetric: {element} and {other}" "" "write the same value in both places"
        "Ixy and Iyx are the same integral.";
    E439 impossible_inertia(name, moments, why, help) "moments of inertia that no body has"
        "no body has the moments of `{name}`: {moments}: {why}" "" "{help}"
        "Principal moments are integrals of squares: none is negative, and no two are less than the third together (equality: a plate or a rod).";
    W440 doubtful_inertia(name, moments, why) "moments of inertia that hardly any body has"
        "the moments of `{name}` are {moments}: {why}" "" "data with few digits? larger moments, by less than a hundredth, make a body of it"
        "Two principal moments are never less than the third together.";
    E441 no_axis() "a turn about no axis"
        "this axis has no direction" "its length is 0 or infinite, by the parameters of a scene" "an axis is x, y, z or a direction `[a, b, c]` of parameters; a quaternion has any length but 0"
        "A frame turns about an axis that is fixed in the frame from which it is turned.";
    E442 needs_axis(key) "a torsional spring or damper in space without an axis"
        "in space the couple of this entry needs a direction" "" "add `{key}: e`, such as `{key}: B.z`"
        "The couple on `on` acts along this direction, the opposite on `from`.";
    E443 too_many_turns(limit) "more turns in space than can be derived"
        "{limit}" "one too many" "leave some out, or divide the model"
        "The expressions of turns grow as the square of their number; the limit bounds time and memory.";
    E444 not_at_rest(name) "inertia about a point that moves in its body"
        "this point is not at rest in `{name}`" "" "give `inertia` about the centre of mass, or about a point that is written with the body's own frame and its `position`"
        "The moments of a rigid body about a point are constant where the point is fixed in the body.";
    E445 period_needed(what) "a motion of a mechanism under inputs without a period"
        "{what} depends on time, so that a motion closes after a period of what acts on it" "the period is not given" "write `closes: {{period: 2*pi/w}}` with the frequency of the inputs"
        "What depends on time repeats itself after certain times only; exchanges, mirrors and reversals hold for shifts of time by a part of these.";
    E446 moving_goal(name, parameter) "a condition that moves with what is unknown"
        "the value of `{name}` contains `{parameter}`, which is unknown" "" "make the difference an output, and let that be 0"
        "Values in `such_that` stay while unknowns are found.";
    E452 not_an_own_axis(axis) "an axis of a joint that is no axis of a frame"
        "`{axis}` is not an axis of a body or frame" "" "write `B.x`, `B.y` or `B.z`; for another direction turn a frame and name its axis: `frames: {{J: {{from: B, rotate: [y, 0.3]}}}}`, `J.z`"
        "The rows of a joint are written with the other two axes of this frame.";
    E453 not_fixed_in_side(what, side) "a point or an axis of a joint that moves in its side"
        "`{what}` is not at rest in `{side}`" "" "list points and axes in the order of the sides, each written with the coordinates that move its side; what moves within its side is no joint: write rows of `constraints`"
        "A joint holds a point and an axis of one body at a point and an axis of another.";
    E454 joint_of_space(kind) "a joint that the plane does not have"
        "there is no `{kind}` in the plane" "" "joints in the plane are `hinge`, `slider`, `weld` and `free`; others are rows of `constraints`"
        "In the plane all axes of rotation are parallel.";
    E455 joint_at_one_point(kind) "a joint in one point that needs two"
        "a `{kind}` needs a point on each side" "one point" "two are `at: [P, Q]`, P by the coordinates of the first side, Q by those of the second; where the two meet by the coordinates already no row is needed"
        "Rows hold the two points together, or on an axis. With one point the coordinates do that, and only the rows of the axes are left.";
    E456 force_not_among_rows(name) "the force of a joint that no row carries"
        "the force of `{name}` is no multiplier" "its sides meet in one point by the coordinates" "give each side a point of its own, `at: [P, Q]`, with coordinates that let them move apart; or name the force in `balances`, `reactions: {{f: {{on: A, at: P, from: B}}}}`"
        "A force that the choice of the coordinates takes in is no unknown of Lagrange's equations.";
    E457 not_two(key, found, example) "a joint without two sides"
        "`{key}` of a joint is a list of two, this is {found}" "" "one for each side: `{key}: {example}`"
        "A joint joins two bodies or frames, one of which may be the ground.";
    E458 own_joint(side) "a joint of a body with itself"
        "this joint joins `{side}` with itself" "" "name two; what holds a body in place is `ground`"
        "A joint holds one side at the other.";
    E459 exchange_unsaid(what, name, label, help) "a mass that changes, and nothing says how"
        "the {what} of `{name}` changes along the motion" "{label}" "{help}"
        "What leaves a body takes momentum with it: m a = ΣF + m' (w − v). A mass of time or of states may stand alone, and then leaves with the velocity of its body; one that the position changes is laid down or taken up, and inertia changes otherwise too.";
    E460 mass_stays(name, key) "an exchange of mass that does not change"
        "the mass of `{name}` does not change" "nothing goes" "remove `{key}`, or give `mass` in time, coordinates or states: `mass: m0 - burnt*t`"
        "What a body loses or gains follows from the rate of its mass.";
    E461 mass_jumps(name) "a mass that jumps"
        "the mass of `{name}` contains `sign` or `step`, or a value that is held" "what would jump off or on at once" "spread it over a time with `min` and `max`, or a table; what separates is a body of its own, held by a constraint of a phase"
        "Mass that goes at once takes momentum at once, which no force m' (w − v) gives.";
    E462 normal_not_across(name) "a normal that does not fit its gap"
        "the gap of `{name}` does not open along its normal" "a motion of `on` along this changes the gap otherwise, or not at all" "`normal` points from what is touched towards `on`, across the surface where both touch; `at` is the point of `on` that touches (absent: its centre of mass), and `from` the body that is touched (absent: the ground)"
        "Balances contain the force along the normal, and friction is limited by it. Where the gap opens in another direction, or at another point, this force is not what keeps the gap from closing.";
    E463 never_happens(name) "an event that never happens"
        "`when` of `{name}` does not change along a run" "an event happens where this passes 0" "write what passes 0: of a place `when: x - x1`, of a time `when: t - t1`, with names of parameters that have units; at equal distances of time `every` instead"
        "Parameters are constant along a run: what is made of them passes 0 nowhere.";
    E464 touched_without_mass(name, contact, phase) "a contact or friction of what has no mass"
        "the coordinate `{name}` carries no mass, and `{contact}` touches what it moves" "nothing determines it while `{phase}`" "give what `{contact}` touches a mass; a spring in series with dry friction may be a state of first order instead, whose rate is that of the spring while its force is below the limit"
        "What has no mass is where the forces on it balance, at every instant. Friction that begins to slip would let it start at once with the speed of what pulls it, and the choice between sticking and slipping goes by accelerations.";
    E465 moving_condition(name, other) "a condition that moves with another one"
        "the value of `{name}` contains `{other}`, which this `when` sets too" "" "write the value that `{name}` has then"
        "A claim with `when` is tested with parameters drawn at random, of which those in `when` get their values.";
}
