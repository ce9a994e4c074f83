//! Machine code read back: its instructions with their source places.
//!
//! Between instructions there are tables of jumps, and after the last one constants and padding. What follows an unconditional jump is an
//! instruction only if a block begins there or something jumps there; Cranelift says where its blocks begin, and traps at the end of
//! the function are reached by jumps before them.

use std::collections::BTreeSet;

use cranelift_module::ModuleRelocTarget;
use iced_x86::{Decoder, DecoderOptions, FlowControl, Instruction};

use crate::compile::{CompiledFunction, Place};

/// A part of a function.
pub enum Part {
    /// `place` is `None` in a function without statements. Code before the first one belongs to it.
    Instruction { instruction: Instruction, place: Option<Place>, target: Option<ModuleRelocTarget> },
    /// Bytes that do not run.
    Data { at: u32, length: u32 },
}

/// The parts of a function in their order; together they are all its bytes.
pub fn parts(function: &CompiledFunction) -> Vec<Part> {
    let length = function.bytes.len() as u32;
    let mut starts: BTreeSet<u32> = function.blocks.iter().copied().collect();
    let mut parts = Vec::new();
    let mut decoder = Decoder::with_ip(64, &function.bytes, 0, DecoderOptions::NONE);
    let (mut at, mut place, mut reloc) = (0, 0, 0);
    while at < length {
        decoder.set_ip(u64::from(at));
        if decoder.set_position(at as usize).is_err() {
            break;
        }
        let instruction = decoder.decode();
        let end = decoder.ip() as u32;
        while function.places.get(place).is_some_and(|next| next.at <= at) {
            place += 1;
        }
        while function.relocs.get(reloc).is_some_and(|next| next.offset < at) {
            reloc += 1;
        }
        let target = function.relocs.get(reloc).filter(|next| next.offset < end).map(|reloc| reloc.name.clone());
        let runs_on = match instruction.flow_control() {
            FlowControl::ConditionalBranch | FlowControl::UnconditionalBranch => {
                starts.insert(instruction.near_branch_target() as u32);
                instruction.flow_control() == FlowControl::ConditionalBranch
            }
            FlowControl::IndirectBranch | FlowControl::Return | FlowControl::Exception => false,
            _ => true,
        };
        let place = function.places.get(place.saturating_sub(1)).copied();
        parts.push(Part::Instruction { instruction, place, target });
        at = end;
        if !runs_on && !starts.contains(&at) {
            let next = starts.range(at..).next().copied().unwrap_or(length).min(length);
            if next > at {
                parts.push(Part::Data { at, length: next - at });
            }
            at = next;
        }
    }
    parts
}
