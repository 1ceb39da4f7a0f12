//! E101–: inside expressions, keys of families, and units.

super::entries! {
    E101 unknown_character(character, help) "a character with no meaning"
        "the character `{character}` means nothing here" "" "{help}"
        "Expressions consist of numbers, names, `+ - * / ^ ( ) [ ] , . ' =`, and `..` in ranges.";
    E102 unexpected(found, expected) "something unexpected"
        "expected {expected}, found {found}" "expected {expected}" ""
        "The expression cannot go on like this.";
    E103 unexpected_end(expected) "an unfinished expression"
        "the expression ends where {expected} should follow" "expected {expected}" ""
        "Something is missing at the end.";
    E104 not_closed(bracket, column, closing, found) "a bracket that is not closed"
        "the `{bracket}` in column {column} of this expression is not closed: expected `{closing}`, found {found}" "expected `{closing}`" "close the `{bracket}`, or remove it"
        "Every parenthesis and bracket that is opened must be closed.";
    E105 not_opened(bracket) "a bracket that was not opened"
        "this `{bracket}` closes nothing" "nothing is open here" "remove it, or open it before"
        "Every parenthesis and bracket that is closed must have been opened.";
    E106 missing_operator(left, right, help) "a missing operator"
        "an operator is missing between `{left}` and `{right}`" "expected an operator" "{help}"
        "There is no implicit multiplication: `2*x`, not `2 x` or `2x`.";
    E107 foreign_operator(operator, help) "an operator of another language"
        "`{operator}` is not an operator here" "" "{help}"
        "The operators are `+ - * / ^`, and `=` in equations.";
    E108 decimal_comma(number) "a decimal comma"
        "a comma cannot stand in a number" "" "did you mean `{number}`?"
        "Decimals are written with a point.";
    E109 bad_number(text) "a number that cannot be read"
        "`{text}` is not a number" "" "numbers are written `2`, `0.5` or `2.5e-3`"
        "A number has digits, at most one point, and perhaps an exponent.";
    E110 expression_too_deep(limit) "an expression too deep"
        "the expression is nested deeper than {limit} levels" "" "give parts of it names in `define`"
        "The limit keeps a hostile expression from exhausting the stack.";
    E111 too_many_primes(name) "more than two primes"
        "`{name}` has more than two primes" "at most two" "third time derivatives are not known; `{name}''` may stand in `outputs`, `checks`, `balances` and `events`"
        "`x'` is a velocity and `x''` an acceleration.";
    E112 prime_misplaced() "a prime after something that is not a name"
        "only a coordinate or an input may have a prime" "" "write `rate(…)` for the time derivative of anything else"
        "`theta'` and `x[i]'` are derivatives of named things.";
    E113 vector_components(found) "a vector of the wrong size"
        "a vector has two or three components, this has {found}" "" ""
        "`[a, b]` in the plane, `[a, b, c]` in space.";
    E114 unknown_component(name) "an unknown component"
        "`.{name}` is not a component" "" "components are `.x`, `.y` and `.z`, and in `reaction(...)` of a contact `.friction`"
        "After a point, body, frame or vector, `.x .y .z` are its components or unit vectors.";
    E115 equation_misplaced(help) "an equals sign out of place"
        "`=` may stand only once, between the two sides of an equation" "" "{help}"
        "Equations `a = b` are allowed in `constraints`, `checks` and `equation`; elsewhere write an expression.";
    E116 empty_expression() "an empty expression"
        "an expression is missing" "" ""
        "Something must stand here.";
    E117 bad_range(found) "a range that cannot be read"
        "expected a range such as `i in 1..n`, found {found}" "expected `i in 1..n`" ""
        "`sum` and families count an index from one integer to another, both included.";
    E118 bad_key(text) "a key that cannot be read"
        "`{text}` is not a name" "" "a key is a name such as `theta1` or `x[2]`, or a family such as `x[i in 1..n]`"
        "Names start with a letter or `_`, and consist of letters, digits and `_`.";
    E119 unknown_unit(unit, help) "an unknown unit"
        "unknown unit `{unit}`" "" "{help}"
        "Units are `kg m s rad deg N J W Pa Hz g A K V ohm H F C Wb T` with SI prefixes, joined by `*`, `/` and `^`; `1` is a pure number.";
    E120 bad_unit(text, expected) "a unit that cannot be read"
        "`{text}` is not a unit: expected {expected}" "" "units look like `kg*m^2/s^2`, `1/m`, `m^-1` or `1`"
        "Units are read from left to right: `N/m*s` is `N s/m`.";
    E121 unit_power(text) "a power of a unit that is neither a small integer nor half of one"
        "`{text}` is not a power that a unit may have" "expected a small integer, or half of one" ""
        "Exponents of units are integers from -9 to 9, or halves of integers: `N/m^1.5`, `N/m^(3/2)`.";
    E122 expression_too_long(limit) "an expression too long"
        "the expression is longer than {limit} bytes" "" "give parts of it names in `define`"
        "The limit keeps a hostile file from exhausting memory.";
    E123 name_too_long(name, limit) "a name too long"
        "the name `{name}` is longer than {limit} bytes" "" "choose a shorter one"
        "Names are repeated in everything that is said about the model, and in the code made from it.";
}
