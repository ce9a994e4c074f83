//! What an instance of a chart keeps and shows: the state of steps and transitions, the mode, and the outputs of the block.

use super::chart::{StepBit, TransitionBit};

/// State of a step. Source: GRAPH reference, D.5.
#[derive(Clone, Debug, Default)]
pub struct StepState {
    pub x: bool,
    pub s1: bool,
    pub s0: bool,
    pub l1: bool,
    pub l0: bool,
    pub v1: bool,
    pub v0: bool,
    pub a1: bool,
    pub r1: bool,
    pub la: bool,
    pub ls: bool,
    pub va: bool,
    pub vs: bool,
    pub t: i64,
    pub u: i64,
    /// An acknowledgement was given while the supervision was still faulty.
    pub acknowledged: bool,
}

impl StepState {
    pub fn bit(&self, member: StepBit) -> bool {
        match member {
            StepBit::X => self.x,
            StepBit::S1 => self.s1,
            StepBit::S0 => self.s0,
            StepBit::L1 => self.l1,
            StepBit::L0 => self.l0,
            StepBit::V1 => self.v1,
            StepBit::V0 => self.v0,
            StepBit::A1 => self.a1,
            StepBit::R1 => self.r1,
            StepBit::LA => self.la,
            StepBit::LS => self.ls,
            StepBit::VA => self.va,
            StepBit::VS => self.vs,
        }
    }
}

/// State of a transition.
#[derive(Clone, Debug, Default)]
pub struct TransitionState {
    pub tv: bool,
    pub tt: bool,
    pub ts: bool,
}

impl TransitionState {
    pub fn bit(&self, member: TransitionBit) -> bool {
        match member {
            TransitionBit::TV => self.tv,
            TransitionBit::TT => self.tt,
            TransitionBit::TS => self.ts,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Auto,
    Manual,
    Tap,
    Top,
}

/// Outputs of the block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    pub s_no: i16,
    pub s_active: bool,
    pub s_time: i64,
    pub s_timeok: i64,
    pub t_no: i16,
    pub error: bool,
    pub fault: bool,
    pub err_flt: bool,
    pub sq_isoff: bool,
    pub sq_halted: bool,
    pub tm_halted: bool,
    pub op_zeroed: bool,
    pub il_enabled: bool,
    pub sv_enabled: bool,
    pub ackreq_enabled: bool,
    pub sskip_enabled: bool,
    pub auto_on: bool,
    pub tap_on: bool,
    pub top_on: bool,
    pub man_on: bool,
}
