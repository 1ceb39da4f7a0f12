//! Text and lists that generated code has as literals.

/// Text that generated code has as a literal, and the interpreter owns.
#[cfg(feature = "alloc")]
pub type Text = alloc::borrow::Cow<'static, str>;
/// A list that generated code has as a literal, and the interpreter owns.
#[cfg(feature = "alloc")]
pub type List<T> = alloc::borrow::Cow<'static, [T]>;

/// Text that generated code has as a literal.
#[cfg(not(feature = "alloc"))]
pub type Text = Literal<str>;
/// A list that generated code has as a literal.
#[cfg(not(feature = "alloc"))]
pub type List<T> = Literal<[T]>;

/// What `Cow` is where there is nothing that it could own.
#[cfg(not(feature = "alloc"))]
#[derive(Debug, PartialEq, Eq)]
pub enum Literal<T: ?Sized + 'static> {
    /// A literal.
    Borrowed(&'static T),
}

#[cfg(not(feature = "alloc"))]
impl<T: ?Sized> core::ops::Deref for Literal<T> {
    type Target = T;

    fn deref(&self) -> &T {
        let Literal::Borrowed(literal) = self;
        literal
    }
}

#[cfg(not(feature = "alloc"))]
impl<T: ?Sized> Clone for Literal<T> {
    fn clone(&self) -> Self {
        let Literal::Borrowed(literal) = self;
        Literal::Borrowed(literal)
    }
}

#[cfg(not(feature = "alloc"))]
impl<T: ?Sized> Default for Literal<T>
where
    &'static T: Default,
{
    fn default() -> Self {
        Literal::Borrowed(<&'static T>::default())
    }
}
