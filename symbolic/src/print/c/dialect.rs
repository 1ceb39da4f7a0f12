//! How C99 writes straight-line functions, and names and words of a file in C.

use crate::expr::{Binary, Number, Table2d, Unary};
use crate::model::local_name;
use crate::print::dialect::{Dialect, Piece};

/// Keywords, macros and functions that no name of generated code may be, beside what Rust forbids.
const TAKEN: &[&str] = &[
    // Keywords of C and C++.
    "auto",
    "break",
    "case",
    "char",
    "const",
    "continue",
    "default",
    "do",
    "double",
    "else",
    "enum",
    "extern",
    "float",
    "for",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "typedef",
    "union",
    "unsigned",
    "void",
    "volatile",
    "while",
    "asm",
    "bool",
    "catch",
    "class",
    "delete",
    "explicit",
    "export",
    "false",
    "friend",
    "mutable",
    "namespace",
    "new",
    "operator",
    "private",
    "protected",
    "public",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typename",
    "using",
    "virtual",
    "wchar_t",
    "and",
    "or",
    "not",
    "xor",
    "alignas",
    "alignof",
    "constexpr",
    "nullptr",
    "thread_local",
    "typeof",
    "complex",
    "imaginary",
    "noreturn",
    // Macros of the headers, and of compilers.
    "NULL",
    "NAN",
    "INFINITY",
    "HUGE_VAL",
    "I",
    "EOF",
    "errno",
    "assert",
    "offsetof",
    "linux",
    "unix",
    "i386",
    "stdin",
    "stdout",
    "stderr",
    "MAXFLOAT",
    "DECIMAL_DIG",
    "FLT_EVAL_METHOD",
    "FLT_RADIX",
    "FLT_ROUNDS",
    "MATH_ERRNO",
    "MATH_ERREXCEPT",
    "math_errhandling",
    "DOMAIN",
    "SING",
    "OVERFLOW",
    "UNDERFLOW",
    "PLOSS",
    "TLOSS",
    "X_TLOSS",
    "HUGE",
    "near",
    "far",
    "min",
    "max",
    "isnan",
    "isinf",
    "isfinite",
    "signbit",
    // Arguments beside those of Rust.
    "p",
    "settings",
    "memory",
    "along",
    // Functions that are called.
    "sqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "pow",
    "fabs",
    "floor",
    "memcpy",
    "dalembert_sign",
    "dalembert_step",
    "dalembert_min",
    "dalembert_max",
    "dalembert_table",
];

/// Macros of `math.h` and `float.h` that come in families: beginnings, middles and ends, which may be empty. Many are there without `-std=c99` only.
const FAMILIES: [[&str; 3]; 5] = [
    ["M_", "E LOG2E LOG10E LN2 LN10 PI PI_2 PI_4 1_PI 2_PI 2_SQRTPI SQRT2 SQRT1_2", " f l f16 f32 f64 f128 f32x f64x"],
    [
        "FLT_ DBL_ LDBL_",
        "DECIMAL_DIG DIG EPSILON HAS_SUBNORM MANT_DIG MAX MAX_10_EXP MAX_EXP MIN MIN_10_EXP MIN_EXP TRUE_MIN NORM_MAX",
        "",
    ],
    ["FP_", "ILOGB0 ILOGBNAN LLOGB0 LLOGBNAN INFINITE NAN NORMAL SUBNORMAL ZERO FAST_FMA FAST_FMAF FAST_FMAL", ""],
    ["FP_INT_", "DOWNWARD TONEAREST TONEARESTFROMZERO TOWARDZERO UPWARD", ""],
    ["HUGE_VAL SNAN", "", " F L _F32 _F64 _F128 _F32X _F64X F32 F64 F128 F32X F64X"],
];

/// All of [`TAKEN`] and of [`FAMILIES`].
pub(super) fn taken() -> impl Iterator<Item = String> {
    let families = FAMILIES.into_iter().flat_map(|[beginnings, middles, ends]| {
        let pairs =
            beginnings.split(' ').flat_map(move |beginning| middles.split(' ').map(move |middle| (beginning, middle)));
        pairs.flat_map(move |(beginning, middle)| ends.split(' ').map(move |end| format!("{beginning}{middle}{end}")))
    });
    TAKEN.iter().map(|name| (*name).to_owned()).chain(families)
}

/// C99; `prefix` is what the names of all functions begin with.
pub(super) struct C<'a> {
    pub prefix: &'a str,
}

impl Dialect for C<'_> {
    fn declare(&self, names: &[&str], values: &[String]) -> String {
        let all: Vec<String> = names.iter().zip(values).map(|(name, value)| format!("{name} = {value}")).collect();
        format!("const double {};", all.join(", "))
    }

    fn unpack(&self, names: &[Option<&str>], array: &str) -> String {
        let named = names.iter().enumerate().filter_map(|(k, name)| Some((k, (*name)?)));
        let all: Vec<String> = named.map(|(k, name)| format!("{name} = {array}[{k}]")).collect();
        format!("const double {};", all.join(", "))
    }

    fn number(&self, number: Number) -> String {
        float(number.to_f64())
    }

    fn unary(&self, function: Unary, x: &Piece) -> String {
        let name = match function {
            Unary::Ln => "log",
            Unary::Abs => "fabs",
            Unary::Sign => "dalembert_sign",
            Unary::Step => "dalembert_step",
            other => other.name(),
        };
        format!("{name}({})", x.text)
    }

    fn binary(&self, function: Binary, x: &Piece, y: &Piece) -> String {
        let name = match function {
            Binary::Pow => "pow",
            Binary::Atan2 => "atan2",
            Binary::Min => "dalembert_min",
            _ => "dalembert_max",
        };
        format!("{name}({}, {})", x.text, y.text)
    }

    fn table(&self, place: usize, order: u8, x: &Piece) -> String {
        format!("{}_table_{place}({}, {order})", self.prefix, x.text)
    }

    fn table_2d(&self, place: usize, table: Table2d, x: &Piece, y: &Piece) -> String {
        let [of_x, of_y] = table.order();
        format!("{}_table_2d_{place}({}, {}, {of_x}, {of_y})", self.prefix, x.text, y.text)
    }

    fn normal(&self, key: u64, seed: &Piece, place: &Piece) -> String {
        format!("{}_normal({}, {}, UINT64_C({key:#018x}))", self.prefix, seed.text, place.text)
    }

    fn turn(&self, names: &[Option<String>; 2], angle: &Piece) -> String {
        let call = |(name, function): (&Option<String>, &str)| {
            name.as_ref().map(|name| format!("{name} = {function}({})", angle.text))
        };
        let all: Vec<String> = names.iter().zip(["sin", "cos"]).filter_map(call).collect();
        format!("const double {};", all.join(", "))
    }

    fn pivot(&self, coordinate: usize, pivot_and_diagonal: [&Piece; 2], indent: &str) -> String {
        let [pivot, diagonal] = pivot_and_diagonal.map(|piece| &piece.text);
        let place = coordinate + 1;
        format!("{indent}if (!(fabs({pivot}) > 4.0 * DBL_EPSILON * fabs({diagonal}))) return {place};")
    }
}

/// A float with all its digits and a decimal point, in parentheses where it is negative.
pub fn float(x: f64) -> String {
    let digits = match format!("{:?}", x.abs()) {
        text if x.is_nan() || text.contains('.') => text,
        text => match text.split_once('e') {
            Some((number, exponent)) => format!("{number}.0e{exponent}"),
            None => text,
        },
    };
    let digits = match digits.as_str() {
        "NaN" => "NAN".to_owned(),
        "inf" => "HUGE_VAL".to_owned(),
        _ => digits,
    };
    if x.is_sign_negative() && !x.is_nan() { format!("(-{digits})") } else { digits }
}

/// Names of files, and a prefix of functions, that stand beside a model's.
const BESIDE: [&str; 8] = [
    "dalembert",
    "dalembert_core",
    "fmi2_functions",
    "fmi3_functions",
    "fmu_calls",
    "fmu_description",
    "fmu_instance",
    "fmu_integrate",
];

/// The headers of C99, which a file of the same name beside the sources may hide.
const HEADERS: [&str; 24] = [
    "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "iso646", "limits", "locale", "math", "setjmp",
    "signal", "stdarg", "stdbool", "stddef", "stdint", "stdio", "stdlib", "string", "tgmath", "time", "wchar",
    "wctype",
];

/// A name of the file inside functions.
pub(super) fn identifier(name: &str) -> String {
    let name = local_name(name).trim_start_matches("r#").to_owned();
    if BESIDE.contains(&name.as_str()) || HEADERS.contains(&name.as_str()) { name + "_" } else { name }
}

/// Words of the file inside a comment, which they neither end nor open.
pub(super) fn comment(words: &str) -> String {
    let mut line = crate::print::words::visible(words);
    // What is left of a replaced pair may make another one: `//**` is `/ / * *`.
    for (pair, apart) in [("*/", "* /"), ("/*", "/ *"), ("??", "? ?")] {
        while line.contains(pair) {
            line = line.replace(pair, apart);
        }
    }
    line.trim_end_matches([' ', '\\']).to_owned()
}

/// A string literal, of any bytes.
pub(super) fn string(words: &str) -> String {
    let byte = |byte: u8| match byte {
        b'"' | b'\\' | b'?' => format!("\\{}", char::from(byte)),
        b' '..=b'~' => char::from(byte).to_string(),
        _ => format!("\\{byte:03o}"),
    };
    format!("\"{}\"", words.bytes().map(byte).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_doubles_of_c() {
        for (x, text) in [
            (1.0, "1.0"),
            (-0.5, "(-0.5)"),
            (1e-7, "1.0e-7"),
            (1.5e300, "1.5e300"),
            (-0.0, "(-0.0)"),
            (f64::INFINITY, "HUGE_VAL"),
            (f64::NAN, "NAN"),
            (0.1 + 0.2, "0.30000000000000004"),
        ] {
            assert_eq!(float(x), text);
        }
    }

    #[test]
    fn files_hide_no_header() {
        let names = ["math", "stdio", "fmu_calls", "mathematics", "pendulum"].map(identifier);
        assert_eq!(names, ["math_", "stdio_", "fmu_calls_", "mathematics", "pendulum"]);
    }

    #[test]
    fn words_end_neither_comments_nor_strings() {
        assert_eq!(comment("a */ b /* c ??/ \\"), "a * / b / * c ? ?/");
        assert_eq!(comment("/*/ **//"), "/ * / ** //");
        assert_eq!(string("a\"b\\ ??= θ\n"), "\"a\\\"b\\\\ \\?\\?= \\316\\270\\012\"");
    }
}
