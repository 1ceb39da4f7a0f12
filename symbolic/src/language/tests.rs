//! What the parser makes of texts: trees as fully bracketed text, problems as code, bytes and message.

use super::*;

fn show(ast: &Ast) -> String {
    let list = |items: &[Ast]| items.iter().map(show).collect::<Vec<_>>().join(",");
    let range = |range: &Range| format!("{} in {}..{}", range.name, show(&range.from), show(&range.to));
    match &ast.kind {
        AstKind::Number(text) => text.clone(),
        AstKind::Name { name, indices, primes } => {
            let indices = if indices.is_empty() { String::new() } else { format!("[{}]", list(indices)) };
            format!("{name}{indices}{}", "'".repeat(usize::from(*primes)))
        }
        AstKind::Negate(e) => format!("(-{})", show(e)),
        AstKind::Binary(operator, a, b) => {
            let sign = match operator {
                Operator::Add => "+",
                Operator::Subtract => "-",
                Operator::Multiply => "*",
                Operator::Divide => "/",
                Operator::Power => "^",
                Operator::Equal => "=",
            };
            format!("({}{sign}{})", show(a), show(b))
        }
        AstKind::Vector(items) => format!("[{}]", list(items)),
        AstKind::Component(e, which) => {
            format!("{}.{}", show(e), ["x", "y", "z", "friction", "w"][usize::from(*which)])
        }
        AstKind::Call { function, arguments, .. } => format!("{function}({})", list(arguments)),
        AstKind::Sum(e, ranges) => {
            format!("sum({}, {})", show(e), ranges.iter().map(range).collect::<Vec<_>>().join(", "))
        }
        AstKind::Integral(e, over) => format!("integral({}, {})", show(e), range(over)),
    }
}

#[test]
fn precedence() {
    for (text, tree) in [
        ("1+2*3", "(1+(2*3))"),
        ("a-b-c", "((a-b)-c)"),
        ("a/b*c", "((a/b)*c)"),
        ("2^3^2", "(2^(3^2))"),
        ("-x^2", "(-(x^2))"),
        ("x^-1", "(x^(-1))"),
        ("x^-y^2", "(x^(-(y^2)))"),
        ("x^-y*z", "((x^(-y))*z)"),
        ("-a*b", "((-a)*b)"),
        ("a*-b", "(a*(-b))"),
        ("--a", "(-(-a))"),
        ("+a - +b", "(a-b)"),
        ("(a+b)*c", "((a+b)*c)"),
    ] {
        assert_eq!(show(&parse(text).unwrap()), tree, "{text}");
    }
}

#[test]
fn forms() {
    for (text, tree) in [
        ("θ_1''", "θ_1''"),
        ("x[mod(i, n) + 1]'", "x[(mod(i,n)+1)]'"),
        ("s[i,j+1]", "s[i,(j+1)]"),
        ("l*[sin(theta1), -cos(theta1)]", "(l*[sin(theta1),(-cos(theta1))])"),
        ("[0, 0, -m*g]", "[0,0,((-m)*g)]"),
        ("velocity(bob).y^2", "(velocity(bob).y^2)"),
        ("(a + b).x", "(a+b).x"),
        ("tip[i-1].x", "tip[(i-1)].x"),
        ("hand.x.y", "hand.x.y"),
        ("sum(m*q[i]^2, i in 1..n, j in i+1..n)", "sum((m*(q[i]^2)), i in 1..n, j in (i+1)..n)"),
        ("integral(rho/2*(b'*x)^2, x in 0..L)", "integral(((rho/2)*((b'*x)^2)), x in 0..L)"),
        ("min(a, b, c) + f()", "(min(a,b,c)+f())"),
        ("atan2 (y, x)", "atan2(y,x)"),
    ] {
        assert_eq!(show(&parse(text).unwrap()), tree, "{text}");
    }
    assert_eq!(show(&parse_equation("a + 1 = b*c").unwrap()), "((a+1)=(b*c))");
    assert_eq!(show(&parse_equation("a").unwrap()), "a");
    let (from, to) = parse_bounds("-2*l..n+1").unwrap();
    assert_eq!((show(&from), show(&to)), ("((-2)*l)".to_owned(), "(n+1)".to_owned()));
    assert!(parse_bounds("1").is_err() && parse_bounds("1..2..3").is_err());
}

#[test]
fn spans_cover_what_they_name() {
    let text = "θ*(a + b).x";
    let ast = parse(text).unwrap();
    assert_eq!(&text[ast.span.range()], text);
    let AstKind::Binary(_, left, right) = ast.kind else { panic!() };
    assert_eq!((&text[left.span.range()], &text[right.span.range()]), ("θ", "(a + b).x"));
}

fn problems(text: &str) -> Vec<String> {
    let problems = parse(text).unwrap_err();
    let show = |problem: &crate::diagnose::Problem| {
        let span = problem.place.span.unwrap();
        format!("{} {:?} {} {}", problem.code, span.range(), problem.message, problem.help)
    };
    problems.iter().map(show).collect()
}

#[test]
fn messages() {
    for (text, wanted) in [
        ("2x", "E106 1..2 an operator is missing between `2` and `x` did you mean `2*x`?"),
        ("2 (a + b)", "E106 2..3 an operator is missing between `2` and `(` did you mean `2*(…)`?"),
        ("(a)(b)", "E106 3..4 an operator is missing between `)` and `(` did you mean `…)*(…)`?"),
        (
            "x'(t - tau)",
            "E106 2..3 an operator is missing between `'` and `(` a product needs `*`: `x'*(…)`; where it is another time that is meant, a run \
             knows the present state only: of `x'` a time tau ago, with `states: {lag: {unit: …, rate: 2*(x' - lag)/tau}}` and its unit, \
             `2*lag - x'` is near (Padé), with a phase off by (omega*tau)^3/12",
        ),
        ("m g", "E106 2..3 an operator is missing between `m` and `g` did you mean `m*g`?"),
        ("sin x", "E106 4..5 an operator is missing between `sin` and `x` did you mean `sin(x)`?"),
        (
            "sin(30 deg)",
            "E106 7..10 an operator is missing between `30` and `deg` a unit follows only a value that stands alone: write `pi/6`, or name the \
             quantity in `parameters`; a product needs `*`",
        ),
        (
            "sin(25 deg)",
            "E106 7..10 an operator is missing between `25` and `deg` a unit follows only a value that stands alone: write `25*pi/180`, or name \
             the quantity in `parameters`; a product needs `*`",
        ),
        (
            "t - 1 s",
            "E106 6..7 an operator is missing between `1` and `s` a unit follows only a value that stands alone: name the quantity in \
             `parameters`; a product needs `*`",
        ),
        ("sin", "E102 3..3 expected `(` after a function's name, found the end write `sin(…)`"),
        ("a +", "E103 3..3 the expression ends where a value should follow "),
        ("a + * b", "E102 4..5 expected a value, found `*` "),
        (
            "(a + b",
            "E104 6..6 the `(` in column 1 of this expression is not closed: expected `)`, found the end close the `(`, or remove it",
        ),
        (
            "[a, (b + c]",
            "E104 10..11 the `(` in column 5 of this expression is not closed: expected `)`, found `]` close the `(`, or remove it",
        ),
        ("a + b)", "E105 5..6 this `)` closes nothing remove it, or open it before"),
        ("1,5*m", "E108 0..3 a comma cannot stand in a number did you mean `1.5`?"),
        ("a ** 2", "E107 2..4 `**` is not an operator here write `^` for a power"),
        ("a && b", "E107 2..4 `&&` is not an operator here conditions are written with `step`, `if:` or `when:`"),
        ("a $ b", "E101 2..3 the character `$` means nothing here "),
        (
            "x'''",
            "E111 1..4 `x` has more than two primes third time derivatives are not known; `x''` may stand in `outputs`, `checks`, `balances` and `events`",
        ),
        (
            "(x)'",
            "E112 3..4 only a coordinate or an input may have a prime write `rate(…)` for the time derivative of anything else",
        ),
        ("x'[1]", "E102 2..3 expected an operator, found `[` the index comes before the prime: `x[…]'`"),
        ("[a]", "E113 0..3 a vector has two or three components, this has 1 "),
        (
            "p.w",
            "E114 2..3 `.w` is not a component components are `.x`, `.y` and `.z`, and in `reaction(...)` of a contact `.friction`",
        ),
        (
            "a = b",
            "E115 2..3 `=` may stand only once, between the two sides of an equation an expression is wanted here; for an equation `a = b` write `a - b`",
        ),
        ("", "E116 0..0 an expression is missing "),
        ("sum(x, i = 1)", "E117 9..10 expected a range such as `i in 1..n`, found `=` "),
        ("sum(x)", "E117 5..6 expected a range such as `i in 1..n`, found `)` "),
        ("x[]", "E102 2..3 expected a value, found `]` "),
    ] {
        assert_eq!(problems(text), [wanted], "{text}");
    }
    let twice = parse_equation("a = b = c").unwrap_err();
    assert_eq!((twice[0].code, twice[0].help.as_str()), ("E115", "write two equations"));
}

#[test]
fn several_problems_in_one_list() {
    let found = problems("max(a b, (c d), e +, 3)");
    assert_eq!(found.iter().map(|text| &text[..4]).collect::<Vec<_>>(), ["E106", "E106", "E102"]);
    assert_eq!(problems("a $ b @ c").len(), 2);
}

#[test]
fn deep_expressions_end_with_an_error() {
    let code = |text: String| parse(&text).unwrap_err()[0].code;
    for open in ["(", "[a,", "-", "sin(", "x[", "2^", "sum("] {
        assert_eq!(code(open.repeat(20_000 / open.len())), "E110", "{open}");
    }
    assert_eq!(code("a".to_owned() + &".x".repeat(1001)), "E110");
    // Sums are long, not deep.
    assert!(parse(&("a".to_owned() + &"+a".repeat(2000))).is_ok());
    assert!(parse(&("(".repeat(190) + "a" + &")".repeat(190))).is_ok());
    assert_eq!(code("x".repeat(1 << 17)), "E122");
}
