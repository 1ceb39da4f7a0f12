//! From arguments to tokens.

use std::path::{Path, PathBuf};

use dalembert_symbolic::{file, lower, print};
use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};

use crate::arguments::{Arguments, Series, Source, Warnings};

/// The items of a mechanism, or one error that tells all problems and a skeleton of the type.
pub fn expand(arguments: &Arguments) -> TokenStream {
    let Found { path, folder, text, span, watch } = match source(&arguments.source) {
        Ok(found) => found,
        Err(error) => return error.to_compile_error(),
    };
    let given = arguments.name.as_ref().map(ToString::to_string);
    match lower::compile_in(folder.as_deref(), &text, &arguments.sizes) {
        Ok(program) => {
            let program = match arguments.series {
                Series::No => program,
                Series::Data => program.with_series(false),
                Series::Written => program.with_series(true),
            };
            let tables = program.model.files.iter().map(|file| watched(&file.to_string_lossy()));
            let tables: TokenStream = tables.collect();
            let name = given.unwrap_or_else(|| print::type_name(&program.model.name));
            let doubts = doubts(arguments.warnings, file::render(&path, &text, &program.model.warnings), span);
            match print::rust(&program, &text, &name).parse::<TokenStream>() {
                Ok(items) => quote! { #watch #tables #doubts #items },
                Err(error) => {
                    let message =
                        format!("dalembert printed text that is not Rust ({error}); this is a fault of dalembert");
                    syn::Error::new(span, message).to_compile_error()
                }
            }
        }
        Err(problems) => {
            let message = file::render(&path, &text, &problems);
            let error = syn::Error::new(span, format!("\n{message}")).to_compile_error();
            let name = given.unwrap_or_else(|| print::type_name(&print::name_in(&text)));
            let skeleton = print::skeleton(&name).parse::<TokenStream>().unwrap_or_default();
            quote! { #watch #error #skeleton }
        }
    }
}

/// What makes the compiler tell the file's warnings where the macro is called.
///
/// Stable Rust lets a macro give errors only.  The use of something deprecated is a warning with a text, which is
/// silenced, and made an error, like any other (`deprecated`).
fn doubts(level: Warnings, message: String, span: Span) -> TokenStream {
    if message.is_empty() || level == Warnings::Allow {
        return TokenStream::new();
    }
    let message = format!("\n{message}");
    if level == Warnings::Deny {
        return syn::Error::new(span, message).to_compile_error();
    }
    quote_spanned! { span =>
        const _: () = {
            #[deprecated(note = #message)]
            const DOUBTFUL_MODEL: () = ();
            DOUBTFUL_MODEL
        };
    }
}

/// A model's text.
struct Found {
    /// To show.
    path: String,
    /// Where the files of its tables are: beside its own, or for inline models in the crate's folder.
    folder: Option<PathBuf>,
    text: String,
    /// Where it is asked for.
    span: Span,
    /// An item that makes Cargo watch the file.
    watch: TokenStream,
}

/// An item that makes Cargo watch a file.
fn watched(path: &str) -> TokenStream {
    quote! { const _: &[u8] = ::core::include_bytes!(#path); }
}

/// The model's text, where it is asked for, and where it is found.
fn source(source: &Source) -> syn::Result<Found> {
    let literal = match source {
        Source::Inline(literal) => {
            let (path, text, span) = ("inline model".to_owned(), literal.value(), literal.span());
            return Ok(Found { path, folder: Some(crate_folder()), text, span, watch: TokenStream::new() });
        }
        Source::Path(literal) => literal,
    };
    let path = literal.value();
    if Path::new(&path).is_absolute() {
        let message =
            "the path of a model file is relative to the crate's folder; an absolute one would not build elsewhere";
        return Err(syn::Error::new(literal.span(), message));
    }
    let file = crate_folder().join(&path);
    let text = std::fs::read_to_string(&file)
        .map_err(|error| syn::Error::new(literal.span(), format!("cannot read `{path}`: {error}")))?;
    let slashed = format!("/{path}");
    let watch = quote! { const _: &[u8] =
    ::core::include_bytes!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), #slashed)); };
    let folder = file.parent().map(Path::to_owned);
    Ok(Found { path, folder, text, span: literal.span(), watch })
}

fn crate_folder() -> PathBuf {
    std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a doubtful model expands to.
    fn doubtful(level: &str) -> String {
        let yaml = "name: Plate\nparameters: {m: 1 kg, l: 1 m}\ncoordinates: {theta: rad}\nbodies:\n  \
                    a: {mass: m, angle: theta, position: \"[l*cos(theta), 0]\"}\n";
        let arguments = syn::parse_str(&format!("yaml = {yaml:?}{level}")).unwrap();
        expand(&arguments).to_string()
    }

    #[test]
    fn warnings_reach_the_compiler() {
        let told = doubtful("");
        assert!(told.contains("deprecated") && told.contains("warning[W420]") && !told.contains("compile_error"));
        assert_eq!(doubtful(", warnings = \"warn\""), told);
        let silent = doubtful(", warnings = \"allow\"");
        assert!(!silent.contains("deprecated") && silent.contains("pub struct Plate"));
        let denied = doubtful(", warnings = \"deny\"");
        assert!(denied.contains("compile_error") && denied.contains("pub struct Plate"));
        assert!(syn::parse_str::<Arguments>("yaml = \"\", warnings = \"never\"").is_err());
    }

    /// Every model of the library: the macro's items are those of the file that `generate` writes.
    #[test]
    fn generated_files_have_the_same_tokens() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let files = std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path());
        let files: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "yaml")).collect();
        assert!(files.len() > 50);
        for file in files {
            let path = format!("../models/{}", file.file_name().unwrap().to_string_lossy());
            let expanded = expand(&syn::parse_str(&format!("{path:?}")).unwrap()).to_string();
            let text = std::fs::read_to_string(&file).unwrap();
            let program = lower::compile_in(Some(&folder), &text, &[]).unwrap();
            let name = print::type_name(&program.model.name);
            let generated =
                print::source_file(&program, &text, &name, print::Purpose::Runs, "dalembert generate\nfn hidden() {}");
            let generated = generated.parse::<TokenStream>().unwrap().to_string();
            assert!(generated.len() > 1000 && expanded.ends_with(&generated), "{path}");
        }
    }

    #[test]
    fn a_model_without_doubts_says_nothing() {
        let yaml = "name: Spring\ncoordinates: {x: }\nkinetic_energy: x'^2/2\n";
        let arguments = syn::parse_str(&format!("yaml = {yaml:?}")).unwrap();
        assert!(!expand(&arguments).to_string().contains("deprecated"));
    }
}
