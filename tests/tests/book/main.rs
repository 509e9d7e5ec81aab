//! The pages of the book: their links and words, their tables, and every command on them.

mod commands;
mod default_drive;
mod pages;
mod protocol_page;
mod tables;
