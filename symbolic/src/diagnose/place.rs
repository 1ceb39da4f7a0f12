//! Building places step by step.

use super::{Place, Problem, Step};
use crate::language::Span;

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

impl Problem {
    /// Whether the model can be used all the same.
    pub fn is_warning(&self) -> bool {
        self.code.starts_with('W')
    }

    /// The same problem, found in a text that stands at `place`; a span there shifts this one's.
    pub fn moved_to(self, place: &Place) -> Problem {
        let offset = place.span.map_or(0, |span| span.start);
        let span = self
            .place
            .span
            .map(|span| Span { start: span.start.saturating_add(offset), end: span.end.saturating_add(offset) });
        Problem { place: Place { span: span.or(place.span), ..place.clone() }, ..self }
    }
}
