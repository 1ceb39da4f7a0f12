//! The macro `dalembert::model!`: a few lines over `dalembert-symbolic`.

mod arguments;
mod expand;

use proc_macro::TokenStream;

/// Generates a mechanism from a model file, at compile time.
///
/// ```ignore
/// dalembert::model!("models/double_pendulum.yaml");                // the type DoublePendulum
/// dalembert::model!("models/chain.yaml", n = 20, name = Chain20);  // sizes and the type's name
/// dalembert::model!(yaml = "name: Bob\n…");                        // inline
/// ```
///
/// Paths are relative to the crate's folder (where its `Cargo.toml` is); absolute paths are refused.  The
/// crate is rebuilt when the file changes.  Everything that is wrong with the file is reported at once, with
/// path, line and column; a skeleton of the type is emitted all the same, so that one mistake gives one message.
///
/// What is doubtful and no error becomes a warning of the compiler, under its lint `deprecated`, since stable Rust has no
/// warnings of macros: `#[allow(deprecated)]` around the macro or `warnings = "allow"` in it silences what is meant,
/// `-D warnings` turns it into an error like any other warning, and `warnings = "deny"` always does:
///
/// ```ignore
/// dalembert::model!("models/two_springs.yaml", warnings = "allow");
/// ```
///
/// `methods = "taylor"` adds the power series of the motion, which `Method::Taylor` needs: by recurrences as data and, of a small model without
/// constraints, by statements, which are two to three times as fast and more for the compiler; `"taylor as data"` has the recurrences alone:
///
/// ```ignore
/// dalembert::model!("models/double_pendulum.yaml", methods = "taylor");
/// ```
#[proc_macro]
pub fn model(input: TokenStream) -> TokenStream {
    let arguments = syn::parse_macro_input!(input as arguments::Arguments);
    expand::expand(&arguments).into()
}
