//! The report: pictures and tables as data ([`figure`]) and the page that shows them ([`render_page`]).
//!
//! Whoever makes results describes them with the types of [`figure`]; nothing there says how they are
//! drawn. [`render_page`] turns them into one HTML file that needs no network and no other file.

pub mod figure;
mod html;
mod page;
pub(crate) mod palette;
mod plot;
mod table;
mod thin;

pub use page::render_page;
