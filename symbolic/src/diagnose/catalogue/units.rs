//! E241–: units that do not fit.

super::entries! {
    E241 unlike_terms(left, left_unit, right, right_unit) "a sum of unlike quantities"
        "`{left}` is {left_unit}, but `{right}` is {right_unit}" "these do not fit" ""
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
}
