//! E201–: names, sizes, indices, and what kind of thing a name stands for.

super::entries! {
    E201 unknown_name(name, help) "an unknown name"
        "unknown name `{name}`" "not declared" "{help}"
        "Everything that an expression names is declared in the file, or built in.";
    E202 duplicate_name(name, section) "a name declared twice"
        "the name `{name}` is already declared in `{section}`" "declared again" "choose another name"
        "Sizes, parameters, coordinates, inputs, definitions, points, bodies, frames and reactions share one space of names.";
    E203 reserved_name(name, proposal) "a reserved name"
        "`{name}` is reserved" "has a meaning of its own" "choose another name, such as `{proposal}`"
        "`t pi ground length all in`, the names of functions and `energy kinetic_energy potential_energy` are built in; `then` of an event knows `stop` and `record`, so that no phase may be called so.";
    E204 index_hides_name(name) "an index that hides a name"
        "the index `{name}` hides a name of the model" "" "choose another letter for the index"
        "An index (or dummy of an integral) may not have the name of something else.";
    E205 member_twice(member) "a member of a family given twice"
        "`{member}` is given twice" "given again" ""
        "A family and its base cases may not overlap.";
    E206 unknown_function(name, help) "an unknown function"
        "unknown function `{name}`" "" "{help}"
        "See LANGUAGE.md, section 1, for the functions. A product needs `*`.";
    E207 argument_count(function, wanted, found) "a wrong number of arguments"
        "`{function}` takes {wanted}, not {found}" "" ""
        "Each function has its number of arguments.";
    E208 argument_kind(function, wanted, found) "an argument of the wrong kind"
        "`{function}` takes {wanted}, this is {found}" "" ""
        "Some functions want vectors, some scalars, some the name of a body or point.";
    E209 vector_size(wanted, found) "vectors of different size"
        "this vector has {found} components where {wanted} are wanted" "{found} components" ""
        "A model's vectors all have two components, or all three; `quaternion(B)` has four.";
    E210 not_a_scalar(found) "a vector where a number is wanted"
        "a number is wanted here, this is {found}" "" "use a component (`.x`), `norm(…)` or `dot(…, …)`"
        "Energies, angles, masses and the like are scalars.";
    E211 not_a_vector(found) "a number where a vector is wanted"
        "a vector is wanted here, this is {found}" "" "write `[a, b]`"
        "Positions, forces and gravity are vectors.";
    E212 mixed_kinds(operator, left, right) "a sum or product of things that do not fit"
        "`{operator}` does not join {left} and {right}" "" ""
        "Vectors are added to vectors and multiplied by numbers; two vectors have `dot` and `cross`.";
    E213 velocity_misplaced(name, context) "a velocity where it may not be"
        "`{name}` is a velocity, and {context} may not depend on velocities" "" ""
        "Positions, angles and potential energies are functions of coordinates and time.";
    E214 acceleration_misplaced(name, context) "an acceleration where it may not be"
        "`{name}` is an acceleration, and {context} may not depend on accelerations" "" "accelerations may stand in `balances`, `outputs`, `checks` and `events`"
        "Accelerations are what the model computes.";
    E215 coordinate_misplaced(name, context) "a coordinate where it may not be"
        "`{name}` depends on the motion, and {context} may not" "" ""
        "Parameters, sizes and the like are fixed before the motion starts.";
    E216 time_misplaced(context) "time where it may not be"
        "{context} may not depend on time" "" ""
        "Parameters, sizes and the like are fixed before the motion starts.";
    E217 definition_cycle(cycle) "definitions that need each other"
        "these definitions need each other: {cycle}" "part of the cycle" ""
        "A definition may use others in any order, but not itself.";
    E218 index_out_of_range(name, index, range) "an index out of its range"
        "`{name}[{index}]` does not exist" "`{name}` has {range}" ""
        "Indices run over the members that the file declares.";
    E219 index_count(name, wanted, found) "a wrong number of indices"
        "`{name}` has {wanted}, here are {found}" "" ""
        "A family is used with as many indices as it is declared with.";
    E220 not_indexed(name) "an index after a name that has none"
        "`{name}` is not a family and takes no index" "" ""
        "Only families, declared like `x[i in 1..n]`, take indices.";
    E221 index_not_integer(text, why) "an index that is not an integer"
        "`{text}` is not an integer known at compile time: {why}" "" ""
        "Indices and the ends of ranges consist of integers, sizes and other indices with `+ - * ^`, `mod` and exact `/`.";
    E222 size_not_integer(name, found) "a size that is not an integer"
        "the size `{name}` must be an integer, this is {found}" "" "sizes are written `{{n: 3}}`"
        "Sizes count members of families.";
    E223 too_many_names(limit) "too many names"
        "the model has more than {limit} names after expansion" "" "use smaller sizes"
        "The limit keeps a hostile file from exhausting memory.";
    E224 wrong_thing(name, wanted, found) "a name of the wrong kind of thing"
        "`{name}` is {found}, not {wanted}" "expected {wanted}" ""
        "Bodies, points, frames and vectors are used in different places.";
    E225 particle_component(name, component) "a component of a particle"
        "the particle `{name}` has no unit vectors" "" "did you mean `position({name}).{component}`?"
        "After a body `.x .y .z` are its unit vectors, and a particle has no orientation.";
    E226 prime_of_other(name, found) "a prime after something that is no coordinate"
        "`{name}` is {found}; only coordinates and inputs have primes" "" "write `rate({name})`"
        "`x'` is a velocity. The time derivative of anything else is `rate(e)`.";
    E227 no_such_component(component) "a third component in the plane"
        "there is no `.{component}` in a planar model" "" ""
        "A model's vectors all have two components, or all three.";
    E228 wrong_place(name, context) "a name that does not exist here"
        "`{name}` has no meaning in {context}" "" ""
        "`length` exists in the law of a spring, `energy` in outputs and the like.";
    E229 too_many_nodes(limit) "a model too large"
        "the model's expressions have more than {limit} parts" "" "use smaller sizes"
        "The limit keeps a hostile file from exhausting memory.";
    E230 power_too_large(power, limit) "a power too large"
        "the integer power {power} is beyond {limit}" "" "write it by smaller ones, such as `x^64*x` or `(x^32)^4`"
        "Integer powers are unrolled into products.";
    E231 undefined_value(text) "a value that does not exist"
        "`{text}` has no value" "" ""
        "A division by zero, the root or logarithm of a negative number, and the like.";
    E232 not_a_symbol(found) "a derivative by something that is no symbol"
        "`diff` wants the name of a coordinate, velocity, parameter or dummy, this is {found}" "" ""
        "`diff(e, x)` is the partial derivative of e by a symbol x.";
    E233 integral_not_resolved(text) "an integral that cannot be computed"
        "the integral of `{text}` is not resolved by any rule within reach" "" "split the range where the integrand has a kink, a pole or a narrow peak, or write the integral in closed form"
        "An integral has a closed form, or a rule of quadrature that is right to 24 digits for parameters near their defaults. It has neither where the integrand is not finite or its integral does not exist, where it has a kink at a place that is no root of something linear in the dummy, or where it oscillates or peaks beyond some hundred points.";
    E234 moving_by_time(words) "a partial derivative by time of what moves"
        "`{words}` moves, and `diff(…, t)` would hold the motion still" "" "write `rate({words})` for the time derivative along the motion"
        "The partial derivative by t leaves out all change through coordinates and inputs. It may stand of what contains t explicitly where an identity is tested, in `checks`, `conserved` and `equation`, and of what does not move.";
    E235 unknown_constraint(name, help) "a constraint that does not exist"
        "there is no constraint `{name}`" "not declared" "{help}"
        "`reaction(c)`, `along` of an impact and the lists of `phases` name entries of `constraints`.";
    E236 unknown_phase(name, help) "a phase that does not exist"
        "there is no phase `{name}`" "not declared" "{help}"
        "`phase`, `then` and scenes name entries of `phases`.";
    E237 reaction_misplaced(words, context) "a reaction where it may not be"
        "`{words}` is a reaction, and {context} may not depend on reactions" "" "reactions may stand in `outputs`, `events`, `checks` and `equation`, and linearly in `forces` and `torques`"
        "The multiplier of a constraint is found together with the accelerations: what determines them linearly may contain it, and what is computed from them.";
    E238 nonlinear_reaction(words, context) "a reaction in something that is not linear in reactions"
        "`{words}` is not linear in its reactions, and {context} must be" "" "use a phase for each sign of the reaction, with a force of its own in each (`-mu*reaction(floor)` in one, `mu*reaction(floor)` in the other), and events that lead from one to the other; beside `friction` and `contacts`, which make the phases, write out the force across, of which `abs` may be taken (`mu*abs(m*g - F)`), or take a contact for each side"
        "Accelerations and reactions come from one system of linear equations. Within a phase a reaction keeps its sign, or is multiplied by anything of coordinates, velocities and time, so that `abs`, `max` or `sign` of it is not needed.";
    E239 switch_misplaced(words, context) "a discontinuity where it may not be"
        "`{words}` has a kink or jumps along the motion, and {context} may not" "" "write one constraint for each side, each active in a phase of its own, and events that lead from one to the other; what has a rate and no inertia, `z' = f`, is a state: `states: {{z: {{rate: f}}}}`"
        "Constraints are differentiated, twice where they contain no velocities; `abs`, `sign`, `step`, `min` and `max` of what moves have no derivative where they switch.";
}
