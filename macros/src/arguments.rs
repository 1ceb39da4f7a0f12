//! What stands between the parentheses of `model!`.

use syn::parse::{Parse, ParseStream};
use syn::{Ident, LitInt, LitStr, Token};

/// A source, sizes, and perhaps a name.
pub struct Arguments {
    /// Where the model comes from.
    pub source: Source,
    /// Sizes that replace those of the file.
    pub sizes: Vec<(String, i64)>,
    /// The type's name, if not the file's.
    pub name: Option<Ident>,
    /// Whether what is doubtful in the file is told.
    pub warnings: Warnings,
    /// What the code has of what Taylor's method needs.
    pub series: Series,
}

/// How a motion's power series are made.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Series {
    /// Not at all.
    No,
    /// By recurrences as data.
    Data,
    /// By statements too, where the model is small.
    Written,
}

/// What becomes of the model file's warnings.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Warnings {
    /// They are warnings of the compiler.
    Warn,
    /// They are dropped.
    Allow,
    /// They are errors.
    Deny,
}

/// Where a model comes from.
pub enum Source {
    /// A file, relative to the crate's folder.
    Path(LitStr),
    /// The text itself.
    Inline(LitStr),
}

impl Parse for Arguments {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let mut source = None;
        if input.peek(LitStr) {
            source = Some(Source::Path(input.parse()?));
        }
        let (mut sizes, mut name, mut warnings, mut series) = (Vec::new(), None, Warnings::Warn, Series::No);
        while !input.is_empty() {
            if source.is_some() {
                input.parse::<Token![,]>()?;
                if input.is_empty() {
                    break;
                }
            }
            let key: Ident = input.parse()?;
            input.parse::<Token![=]>()?;
            if key == "yaml" && source.is_none() {
                source = Some(Source::Inline(input.parse()?));
            } else if key == "name" {
                name = Some(input.parse()?);
            } else if key == "warnings" && input.peek(LitStr) {
                warnings = level(&input.parse()?)?;
            } else if key == "methods" && input.peek(LitStr) {
                let methods: LitStr = input.parse()?;
                series = match &*methods.value() {
                    "taylor" => Series::Written,
                    "taylor as data" => Series::Data,
                    _ => {
                        let expected = "expected `\"taylor\"`: all other methods need nothing more";
                        return Err(syn::Error::new(methods.span(), expected));
                    }
                };
            } else {
                let negative = input.parse::<Option<Token![-]>>()?.is_some();
                let size: i64 = input.parse::<LitInt>()?.base10_parse()?;
                sizes.push((key.to_string(), if negative { -size } else { size }));
            }
        }
        let expected = "expected the path of a model file, or `yaml = \"…\"`";
        let source = source.ok_or_else(|| input.error(expected))?;
        Ok(Arguments { source, sizes, name, warnings, series })
    }
}

fn level(literal: &LitStr) -> syn::Result<Warnings> {
    match literal.value().as_str() {
        "warn" => Ok(Warnings::Warn),
        "allow" => Ok(Warnings::Allow),
        "deny" => Ok(Warnings::Deny),
        _ => Err(syn::Error::new(literal.span(), "expected `\"warn\"`, `\"allow\"` or `\"deny\"`")),
    }
}
