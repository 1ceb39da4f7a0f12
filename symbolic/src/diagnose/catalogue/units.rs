//! E241–: units that do not fit.

super::entries! {
    E241 unlike_terms(left, left_unit, right, right_unit, help) "a sum of unlike quantities"
        "`{left}` is {left_unit}, but `{right}` is {right_unit}" "these do not fit" "{help}"
        "Terms of a sum, sides of an equation, components of a vector and arguments of `min`, `max` and `atan2` have one unit. A bare number is pure; 0 fits all. What depends on a name declared without a unit is not checked.";
    E242 wrong_unit(words, found, what, wanted, help) "a quantity of the wrong kind"
        "`{words}` is {found}, but {what} is {wanted}" "{found}" "{help}"
        "Energies are in J, forces in N, positions in m, and so on; values convert to SI. Energies written without bodies may all be per unit mass (m^2/s^2) or per moment of inertia (1/s^2).";
    E243 not_pure(function, words, found, help) "a function of a quantity with a unit"
        "`{function}` wants a pure number, and `{words}` is {found}" "{found}" "{help}"
        "sin, exp, ln and the like have no meaning for lengths, times and so on. A radian is 1.";
    E244 impure_power(base, base_unit, exponent) "a power with an unknown unit"
        "`{base}` is {base_unit}, and the exponent `{exponent}` is not a number" "" "divide the base by a reference value of the same unit"
        "The unit of a power follows from its exponent, which must therefore be a number, or the base pure.";
    E245 exponent_with_unit(exponent, found) "an exponent with a unit"
        "the exponent `{exponent}` is {found}" "an exponent is a pure number" ""
        "A power with an exponent in metres or seconds has no meaning.";
    E246 scaled_twice(words, si) "a unit other than SI's after a computed value"
        "`{words}` is computed in SI, and the unit after it would scale nothing" "" "write `{si}` after it"
        "A unit converts a number before it. What is computed from quantities with units, or by `asin`, `acos`, `atan` and `atan2`, is in SI already, and a unit after it only says which.";
    E247 cycles_for_radians(unit, what, help) "cycles where radians are counted, or the other way round"
        "`{unit}` does not fit {what}: `Hz` counts cycles, `rad/s` and `rpm` angles" "a factor of 2 pi is missing" "{help}"
        "A cycle is 2 pi rad. `Hz` is 1/s everywhere in a file, as SI has it, so that a frequency in Hz enters an angle as `2*pi*f*t`; a value in Hz is not taken for an angular velocity, nor one in rad/s for a frequency. `--omega` takes either and converts.";
    W248 cycles_in_angle(name) "a frequency in Hz in an angle, without 2 pi"
        "`{name}` is in Hz, cycles a second, and enters an angle without a factor 2 pi" "counts as so many radians a second" "use `2*pi*{name}` in the angle, or declare it in `rad/s` (`rpm`)"
        "`Hz` is 1/s: `cos(f*t)` with `f: 5 Hz` has 5 rad/s, and `cos(2*pi*f*t)` has 5 cycles a second.";
    E249 unlike_exchange(name, unit, other, other_unit) "an exchange of unlike quantities"
        "`{name}` is {unit}, and `{other}` is {other_unit}: they cannot be exchanged" "" "exchange coordinates of one unit"
        "What comes in the place of a coordinate has its unit.";
    W250 degrees_for_radians(name, value) "an angle in radians that looks like one in degrees"
        "`{name}` is in radians, and `{value}` looks like degrees" "{value} rad" "write `{value} deg`, or `{value} rad` where that is meant"
        "A bare number is in the SI unit of what it sets, and the SI unit of an angle is the radian. A whole number of 10 to 360 that is a multiple of 5 is taken as written, with this warning.";
}
