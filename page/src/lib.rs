//! The library for a page of a browser: it is asked in JSON and answers in JSON.
//!
//! JavaScript writes a question to where [`question`] says, calls [`answer`], and reads so many bytes from where [`answered`] says.

mod ask;

use std::cell::RefCell;

use ask::Desk;

thread_local! {
    static QUESTION: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static DESK: RefCell<Desk> = RefCell::default();
}

/// Makes room for a question of so many bytes, and tells where.
#[unsafe(no_mangle)]
pub extern "C" fn question(length: usize) -> *mut u8 {
    QUESTION.with_borrow_mut(|room| {
        room.clear();
        room.resize(length, 0);
        room.as_mut_ptr()
    })
}

/// Answers the question that stands there, and tells how many bytes the answer has.  Where that ends in a panic, what it says is the answer, of
/// [`panicked`] bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    ANSWER.take();
    std::panic::set_hook(Box::new(|panic| ANSWER.set(panic.to_string().into_bytes())));
    let question = QUESTION.take();
    let found = DESK.with_borrow_mut(|desk| desk.answer(&question)).to_string();
    ANSWER.set(found.into_bytes());
    panicked()
}

/// How many bytes there are to read after a panic.
#[unsafe(no_mangle)]
pub extern "C" fn panicked() -> usize {
    ANSWER.with_borrow(Vec::len)
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answered() -> *const u8 {
    ANSWER.with_borrow(Vec::as_ptr)
}
