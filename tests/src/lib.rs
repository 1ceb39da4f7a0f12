//! What the tests of the workspace share.

pub mod at_once;
pub mod both;
pub mod case;
pub mod digits;
pub mod euler;
pub mod random_contacts;
pub mod random_runs;
pub mod reference;
pub mod told;
