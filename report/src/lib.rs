//! The report: pictures and tables as data ([`figure`]) and the page that shows them
//! ([`render_page`]).
//!
//! Whoever makes results describes them with the types of [`figure`]; nothing there says how they
//! are drawn. [`render_page`] turns them into one HTML file that needs no network and no other
//! file.

pub mod figure;
pub mod files;
mod html;
mod kept;
pub mod numbers;
mod page;
mod palette;
mod path;
mod plot;
pub mod smooth;
mod table;
mod thin;

pub use files::linked;
pub use kept::{Kept, NotKept, read_page};
pub use page::render_page;
