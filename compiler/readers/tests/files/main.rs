//! What the readers make of files, sound and damaged. One program for all, since each costs as much to link.

mod draw;
mod gr7_mistakes;
mod gr7_print;
mod graph_xml;
mod notation;
mod robust;
mod sd_graphs;
mod sources;
