//! The table of functions and of reserved names.

/// A function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    /// As written.
    pub name: &'static str,
    /// Smallest number of arguments.
    pub least: usize,
    /// Largest number of arguments; `usize::MAX`: any.
    pub most: usize,
    /// One line of documentation.
    pub about: &'static str,
}

impl Function {
    /// "1 argument", "1 or 2 arguments", "2 or more arguments".
    pub fn arity(&self) -> String {
        match (self.least, self.most) {
            (least, usize::MAX) => format!("{least} or more arguments"),
            (1, 1) => "1 argument".to_owned(),
            (least, most) if least == most => format!("{least} arguments"),
            (least, most) => format!("{least} to {most} arguments"),
        }
    }

    /// Whether it takes so many arguments.
    pub fn takes(&self, count: usize) -> bool {
        (self.least..=self.most).contains(&count)
    }
}

/// The function of this name.
pub fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// Whether a model may not declare this name.
pub fn is_reserved(name: &str) -> bool {
    RESERVED.contains(&name) || (function(name).is_some() && !UNRESERVED.contains(&name))
}

/// Functions that came when models had things of these names: those keep them.
const UNRESERVED: &[&str] = &["angles", "components", "quaternion", "momentum", "angular_momentum", "moment"];

/// Reserved names besides those of the functions.
pub const RESERVED: &[&str] =
    &["t", "pi", "ground", "length", "all", "in", "energy", "kinetic_energy", "potential_energy"];

/// What functions of other languages are here, by their names there.
const ELSEWHERE: &[(&[&str], &str)] = &[
    (&["log", "loge"], "ln(x)"),
    (&["log10", "lg"], "ln(x)/ln(10)"),
    (&["log2", "ld"], "ln(x)/ln(2)"),
    (&["pow", "power"], "x^n"),
    (&["arcsin"], "asin(x)"),
    (&["arccos"], "acos(x)"),
    (&["arctan"], "atan(x)"),
    (&["arctan2"], "atan2(y, x)"),
    (&["cot"], "1/tan(x)"),
    (&["sec"], "1/cos(x)"),
    (&["csc"], "1/sin(x)"),
    (&["hypot"], "sqrt(x^2 + y^2)"),
    (&["square"], "x^2"),
    (&["fabs"], "abs(x)"),
    (&["sgn", "signum"], "sign(x)"),
    (&["heaviside", "Heaviside"], "step(x)"),
    (&["der", "ddt", "derivative"], "rate(x)"),
    (&["magnitude", "mag"], "norm(r)"),
    (&["normalize", "normalise"], "unit(r)"),
];

/// What stands for a delay: Padé's approximation of order 1, of which the phase lags by ωτ to (ωτ)³/12.
pub fn lag(name: &str) -> String {
    format!(
        "a run knows the present state only: of `{name}` a time tau ago, with `states: {{lag: {{unit: …, rate: 2*({name} - lag)/tau}}}}` and its unit, \
         `2*lag - {name}` is near (Padé), with a phase off by (omega*tau)^3/12"
    )
}

/// What is said of `name(…)` where the name is that of a value: a product, or the value at another time.
pub fn at_another_time(name: &str) -> String {
    format!("a product needs `*`: `{name}*(…)`; where it is another time that is meant, {}", lag(name))
}

/// How a function of another language is written here.
pub fn written_here(name: &str) -> Option<&'static str> {
    ELSEWHERE.iter().find(|(names, _)| names.contains(&name)).map(|(_, here)| *here)
}

const fn of(name: &'static str, count: usize, about: &'static str) -> Function {
    Function { name, least: count, most: count, about }
}

/// Every function of LANGUAGE.md, section 1.
pub const FUNCTIONS: &[Function] = &[
    of("sin", 1, "sine of an angle in radians"),
    of("cos", 1, "cosine of an angle in radians"),
    of("tan", 1, "tangent of an angle in radians"),
    of("asin", 1, "inverse sine, -pi/2 to pi/2"),
    of("acos", 1, "inverse cosine, 0 to pi"),
    of("atan", 1, "inverse tangent, -pi/2 to pi/2"),
    of("atan2", 2, "angle of the vector [x, y] given as atan2(y, x), -pi to pi"),
    of("sinh", 1, "hyperbolic sine"),
    of("cosh", 1, "hyperbolic cosine"),
    of("tanh", 1, "hyperbolic tangent"),
    of("exp", 1, "exponential"),
    of("ln", 1, "natural logarithm"),
    of("sqrt", 1, "square root"),
    of("abs", 1, "absolute value"),
    of("sign", 1, "-1, 0 or 1"),
    Function { name: "min", least: 2, most: usize::MAX, about: "the least of its arguments" },
    Function { name: "max", least: 2, most: usize::MAX, about: "the greatest of its arguments" },
    of("step", 1, "Heaviside's step: 0 for x < 0, 1 for x >= 0"),
    of("mod", 2, "remainder of integers in indices, 0 <= mod(a, b) < b"),
    of("dot", 2, "scalar product of two vectors"),
    of("cross", 2, "vector product; a scalar for planar vectors; of a scalar w and a planar vector, w*[-y, x]"),
    of("norm", 1, "length of a vector"),
    of("unit", 1, "a vector divided by its length; zero for the zero vector"),
    of("rate", 1, "total time derivative along the motion"),
    of("position", 1, "position of a point, or of a body's centre of mass"),
    Function {
        name: "velocity",
        least: 1,
        most: 2,
        about: "of a point, or of the material of a body that is at a point",
    },
    Function {
        name: "acceleration",
        least: 1,
        most: 2,
        about: "of a point, or of the material of a body that is at a point",
    },
    of("angular_velocity", 1, "of a body or frame: a scalar in the plane, a vector in space"),
    of("components", 2, "of a vector along the axes of a body or frame"),
    of("angles", 2, "of a body or frame in space, for a sequence of axes such as zxz"),
    of("quaternion", 1, "[w, x, y, z] of length 1, of a body or frame in space"),
    of("momentum", 1, "of a body, or of `all`"),
    Function {
        name: "angular_momentum",
        least: 1,
        most: 2,
        about: "of a body about its centre of mass, of a body or `all` about a point, of all bodies about a point",
    },
    of("diff", 2, "partial derivative by a symbol"),
    Function { name: "sum", least: 2, most: usize::MAX, about: "sum(e, i in 1..n): both ends included" },
    of("integral", 2, "integral(e, x in a..b): in closed form, or by quadrature to 24 digits"),
    of("reaction", 1, "the multiplier of a constraint; the force of a joint on its first side"),
    of("moment", 1, "the couple of a joint on its first side"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arities_read_well() {
        assert_eq!(function("sin").unwrap().arity(), "1 argument");
        assert_eq!(function("velocity").unwrap().arity(), "1 to 2 arguments");
        assert_eq!(function("min").unwrap().arity(), "2 or more arguments");
        assert!(function("min").unwrap().takes(7) && !function("min").unwrap().takes(1));
    }

    #[test]
    fn reserved_names() {
        assert!(is_reserved("t") && is_reserved("sin") && is_reserved("energy"));
        assert!(!is_reserved("theta") && !is_reserved("g"));
    }
}
