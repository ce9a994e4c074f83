//! What plcc and its executables do as commands. One program for all, since each costs as much to link.

mod convert;
mod coverage;
mod executable;
mod flags;
mod fmt;
mod linking;
mod lsp;
mod mistakes;
mod new;
mod partial;
mod partners;
mod rename;
mod stations;
mod status;
mod view;
