//! The macro `dalembert::model!`.

/// Generates a mechanism from a model file.
#[proc_macro]
pub fn model(_input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    proc_macro::TokenStream::new()
}
