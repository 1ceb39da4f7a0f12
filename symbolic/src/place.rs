//! Where something stands: bytes of a text, and a path of keys and indices down a model file.

/// Where in a model file: a path of keys and indices, and then perhaps some bytes of the scalar there.
///
/// With an empty path the span counts bytes of the file itself; that is how errors of YAML's own syntax are placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// From the root down.
    pub path: Vec<Step>,
    /// True when the key itself is meant, not its value.
    pub key: bool,
    /// Bytes of the scalar's (or key's) text; `None`: all of it.
    pub span: Option<Span>,
}

/// One step down into a YAML file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// Into a mapping, by the key as written.
    Key(String),
    /// Into a list.
    Index(usize),
}

impl Place {
    /// The value under `key` in the mapping at this place.
    pub fn key(&self, key: &str) -> Place {
        self.step(Step::Key(key.to_owned()))
    }

    /// The item `index` (from 0) of the list at this place.
    pub fn index(&self, index: usize) -> Place {
        self.step(Step::Index(index))
    }

    /// The key itself instead of its value.
    pub fn of_key(&self) -> Place {
        Place { key: true, span: None, ..self.clone() }
    }

    /// Some bytes of the scalar (or key) at this place.
    pub fn at(&self, span: Span) -> Place {
        Place { span: Some(span), ..self.clone() }
    }

    /// Bytes of the file itself.
    pub fn in_file(start: usize, end: usize) -> Place {
        Place { span: Some(Span::new(start, end)), ..Place::default() }
    }

    fn step(&self, step: Step) -> Place {
        let mut path = self.path.clone();
        path.push(step);
        Place { path, key: false, span: None }
    }
}

/// A range of bytes in an expression's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// Bytes `start..end`; beyond 4 GB both saturate.
    pub fn new(start: usize, end: usize) -> Span {
        let bound = |byte| u32::try_from(byte).unwrap_or(u32::MAX);
        Span { start: bound(start), end: bound(end) }
    }

    /// From the start of this to the end of `other`.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start, end: other.end }
    }

    /// These bytes of a text whose own place is not known yet; see [`Problem::moved_to`](crate::diagnose::Problem::moved_to).
    pub fn place(self) -> Place {
        Place { span: Some(self), ..Place::default() }
    }

    /// As a range of indices.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}
