//! The files that a model names: those of its tables and of records.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::section::tables::text_of;

/// Where the files that a model names are, and the texts of those that were read before and are not read again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    /// The folder beside which names stand; `None`: the model is in none, and may name no files.
    pub folder: Option<PathBuf>,
    /// Texts by their paths.
    pub kept: Arc<[(PathBuf, String)]>,
}

impl Files {
    /// Files that are read when they are named.
    pub fn of_folder(folder: Option<&Path>) -> Files {
        Files { folder: folder.map(Path::to_owned), kept: Arc::default() }
    }

    /// The text at a path.
    ///
    /// # Errors
    /// Why there is none.
    pub fn text(&self, path: &Path) -> Result<String, String> {
        let kept = self.kept.iter().find(|(kept, _)| kept == path);
        kept.map_or_else(|| text_of(path), |(_, text)| Ok(text.clone()))
    }
}
