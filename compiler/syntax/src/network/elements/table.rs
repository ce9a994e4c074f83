//! The rows of all elements.
//!
//! Pins are a list of words: `?` before one that may be missing, `>` before an output, `=` before one that is read and written, `|` between
//! spellings (the first one is the pin's name in the syntax tree), `+` after the first of numbered pins (`in1+` is in1, in2, …).
//! Letter case does not matter. Source: LAD/FBD reference, chapter B; what each kind does: chapter C.

use super::{Chapter, CounterCoil, EnoRule, Flag, Gate, Kind, Mcr, ReturnValue, Row, Typing, VariantQuestion};

const fn row(
    name: &'static str,
    xml: &'static [&'static str],
    open: &'static [&'static str],
    pins: &'static str,
    flow: (&'static str, &'static str),
    kind: Kind,
) -> Row {
    Row { name, sd: &[], xml, open, pins, flow, kind, typing: Typing::NONE, eno: None }
}

/// A box with EN and ENO; both are added to its pins.
const fn en(
    name: &'static str,
    xml: &'static [&'static str],
    open: &'static [&'static str],
    pins: &'static str,
    kind: Kind,
) -> Row {
    Row { name, sd: &[], xml, open, pins, flow: ("en", "eno"), kind, typing: Typing::NONE, eno: None }
}

impl Row {
    const fn sd(mut self, names: &'static [&'static str]) -> Row {
        self.sd = names;
        self
    }

    const fn own_types(mut self) -> Row {
        self.typing.own_types = true;
        self
    }

    const fn own_pins(mut self, pins: &'static [&'static str]) -> Row {
        self.typing.own_pins = pins;
        self
    }

    const fn output_pins(mut self, pins: &'static [&'static str]) -> Row {
        self.typing.output_pins = pins;
        self
    }

    const fn follows_output(mut self) -> Row {
        self.typing.follows_output = true;
        self
    }

    const fn named_by_output(mut self) -> Row {
        self.typing.named_by_output = true;
        self
    }

    const fn eno(mut self, rule: EnoRule) -> Row {
        self.eno = Some(rule);
        self
    }
}

const IN_OUT: (&str, &str) = ("in", "out");
const PRE: (&str, &str) = ("pre", "out");
const COMPARE: &str = "?pre|en in1 in2 ?>out|eno";
const S5_TIMER: &str = "?timer|operand|t_no|no s|in ?tv|pt|value ?r ?>bi|rt ?>bcd|rtbcd ?>q ?>out";
const S5_COUNTER: &str = "?counter|operand|c_no|no ?cu ?cd ?s ?pv ?r ?>cv|cvbin ?>cv_bcd|cvbcd ?>q";
const TYPES: &str = "?pre|en in1|operand1 in2|operand2 ?>out|eno";
const FLAG: &str = "?pre|in ?>out";
const UNARY: &str = "?en in ?>out ?>eno";
const BINARY: &str = "?en in1 in2 ?>out ?>eno";
const MANY: &str = "?en in1+ ?>out ?>eno";
const SHIFT: &str = "?en in n ?>out ?>eno";

use Kind::{
    BitField, Calculate, CallCoil, Coil, Compare, Condition, Contact, Convert, CounterCoil as CountCoil, Demux,
    EdgeCoil, EdgeContact, EdgeTrigger, Flag as StatusFlag, FlipFlop, Formula, Function, Gate as LogicGate, Instance,
    Invert, Jump, JumpList, Mcr as McrCoil, Move, Mux, Negate, Not, OpenDb, Operator, PresetTimer, Procedure, Range,
    ResetCoil, ResetTimer, Return, Round, S5Counter, S5Timer, Save, SetCoil, Step, Switch, TimerCoil, Valid, Variant,
};

/// All elements, by chapter.
#[rustfmt::skip]
pub static CHAPTERS: &[Chapter] = &[
    Chapter {
        // Chapter B.1.
        title: "Bit logic",
        source: "C.2 to C.4",
        rows: &[
            row("Contact", &["Contact"], &[], "in operand >out", IN_OUT, Contact),
            row("Not", &["Not", "NotContact"], &["NOT"], "in >out", IN_OUT, Not),
            row("A", &["A"], &["AND"], "in1+ >out", ("in1", "out"), LogicGate(Gate::And)),
            row("O", &["O"], &["OR"], "in1+ >out", ("in1", "out"), LogicGate(Gate::Or)),
            row("X", &["X"], &["XOR"], "in1+ >out", ("in1", "out"), LogicGate(Gate::Xor)),
            row("P_Contact", &["PContact", "P_Contact"], &[], "?pre|in operand =bit >out", PRE, EdgeContact { rising: true }),
            row("N_Contact", &["NContact", "N_Contact"], &[], "?pre|in operand =bit >out", PRE, EdgeContact { rising: false }),
            row("P_Trig", &["PBox", "P_TRIG", "PTrig", "P_Box"], &[], "in|clk =bit|operand >out|q", IN_OUT, EdgeTrigger { rising: true }),
            row("N_Trig", &["NBox", "N_TRIG", "NTrig", "N_Box"], &[], "in|clk =bit|operand >out|q", IN_OUT, EdgeTrigger { rising: false }),
            en("R_TRIG", &["R_TRIG"], &["R_TRIG"], "?en clk ?>q ?>eno", Instance("R_TRIG")),
            en("F_TRIG", &["F_TRIG"], &["F_TRIG"], "?en clk ?>q ?>eno", Instance("F_TRIG")),
            row("Coil", &["Coil", "Assign"], &[], "in >operand ?>out", IN_OUT, Coil),
            row("S_Coil", &["SCoil", "SetCoil", "S_Coil"], &[], "in >operand ?>out", IN_OUT, SetCoil),
            row("R_Coil", &["RCoil", "ResetCoil", "R_Coil"], &[], "in >operand ?>out", IN_OUT, ResetCoil),
            row("P_Coil", &["PCoil", "P_Coil"], &[], "in >operand =bit ?>out", IN_OUT, EdgeCoil { rising: true }),
            row("N_Coil", &["NCoil", "N_Coil"], &[], "in >operand =bit ?>out", IN_OUT, EdgeCoil { rising: false }),
            row("S_BitfieldCoil", &["SET_BF", "SetBf", "SCoil_BF", "SBitfieldCoil", "SBitfield", "SetBitField", "SET_BITFIELD", "SetBitFieldCoil", "S_BitfieldCoil", "SetBfCoil"], &[], "in|en >operand|s_bit|out_bit n|count ?>out|eno", IN_OUT, BitField { set: true }),
            row("R_BitfieldCoil", &["RESET_BF", "ResetBf", "RCoil_BF", "RBitfieldCoil", "RBitfield", "ResetBitField", "RESET_BITFIELD", "ResetBitFieldCoil", "R_BitfieldCoil", "ResetBfCoil"], &[], "in|en >operand|r_bit|out_bit n|count ?>out|eno", IN_OUT, BitField { set: false }),
            row("S_SR", &["Sr", "S_SR"], &["RS"], "s =operand ?r1 ?>q|q1", ("s", "q"), FlipFlop { set_wins: false }).sd(&["SR"]),
            row("S_RS", &["Rs", "S_RS"], &["SR"], "r =operand ?s1 ?>q|q1", ("r", "q"), FlipFlop { set_wins: true }).sd(&["RS"]),
        ],
    },
    Chapter {
        // Chapter B.2.
        title: "Comparators",
        source: "C.5",
        rows: &[
            row("EQ", &["Eq"], &["EQ"], COMPARE, PRE, Compare("=")).sd(&["EQ_Contact"]),
            row("NE", &["Ne"], &["NE"], COMPARE, PRE, Compare("<>")).sd(&["NE_Contact"]),
            row("GE", &["Ge"], &["GE"], COMPARE, PRE, Compare(">=")).sd(&["GE_Contact"]),
            row("LE", &["Le"], &["LE"], COMPARE, PRE, Compare("<=")).sd(&["LE_Contact"]),
            row("GT", &["Gt"], &["GT"], COMPARE, PRE, Compare(">")).sd(&["GT_Contact"]),
            row("LT", &["Lt"], &["LT"], COMPARE, PRE, Compare("<")).sd(&["LT_Contact"]),
            row("InRange", &["InRange", "IN_RANGE"], &[], "?pre min in|val max ?>out", PRE, Range { inside: true }),
            row("OutRange", &["OutRange", "OUT_RANGE"], &[], "?pre min in|val max ?>out", PRE, Range { inside: false }),
            row("OK", &["IsValid", "OK", "OkContact", "OK_Contact", "IsValidContact"], &[], "?pre|in operand ?>out", PRE, Valid { valid: true }).sd(&["IsValidContact", "OK_Contact"]),
            row("IS_NULL", &["IsNull", "IS_NULL"], &[], "?pre|in operand ?>out", PRE, Variant(VariantQuestion::IsNull { null: true })),
            row("NOT_NULL", &["NotNull", "NOT_NULL"], &[], "?pre|in operand ?>out", PRE, Variant(VariantQuestion::IsNull { null: false })),
            row("IS_ARRAY", &["IsArray", "IS_ARRAY"], &[], "?pre|in operand ?>out", PRE, Variant(VariantQuestion::IsArray)),
            row("EQ_Type", &["EqType", "EQ_Type"], &[], TYPES, PRE, Variant(VariantQuestion::SameType { elements: false, same: true })).sd(&["EQ_Type_Contact"]),
            row("NE_Type", &["NeType", "NE_Type"], &[], TYPES, PRE, Variant(VariantQuestion::SameType { elements: false, same: false })).sd(&["NE_Type_Contact"]),
            row("EQ_ElemType", &["EqElemType", "EQ_ElemType"], &[], TYPES, PRE, Variant(VariantQuestion::SameType { elements: true, same: true })).sd(&["EQ_ElemType_Contact"]),
            row("NE_ElemType", &["NeElemType", "NE_ElemType"], &[], TYPES, PRE, Variant(VariantQuestion::SameType { elements: true, same: false })).sd(&["NE_ElemType_Contact"]),
            row("NOK", &["IsNotValid", "NOT_OK", "IsInvalid", "NotOkContact", "NOK", "NotOk", "NotIsValid", "IsNotValidContact"], &[], "?pre|in operand ?>out", PRE, Valid { valid: false }).sd(&["IsNotValidContact", "NOT_OK"]),
        ],
    },
    Chapter {
        // Chapter B.3.
        title: "Timers and counters",
        source: "C.6, C.7, C.19",
        rows: &[
            row("TP", &["TP"], &["TP"], "?en in pt ?>q ?>et ?>eno", ("in", "q"), Instance("TP")),
            row("TON", &["TON"], &["TON"], "?en in pt ?>q ?>et ?>eno", ("in", "q"), Instance("TON")),
            row("TOF", &["TOF"], &["TOF"], "?en in pt ?>q ?>et ?>eno", ("in", "q"), Instance("TOF")),
            row("TONR", &["TONR"], &["TONR"], "?en in ?r pt ?>q ?>et ?>eno", ("in", "q"), Instance("TONR")),
            row("TP_Coil", &["CoilTP", "TP_Coil", "TPCoil"], &[], "in timer|operand pt|value ?>out", IN_OUT, TimerCoil("TP")),
            row("TON_Coil", &["CoilTON", "TON_Coil", "TONCoil"], &[], "in timer|operand pt|value ?>out", IN_OUT, TimerCoil("TON")),
            row("TOF_Coil", &["CoilTOF", "TOF_Coil", "TOFCoil"], &[], "in timer|operand pt|value ?>out", IN_OUT, TimerCoil("TOF")),
            row("TONR_Coil", &["CoilTONR", "TONR_Coil", "TONRCoil"], &[], "in timer|operand pt|value ?>out", IN_OUT, TimerCoil("TONR")),
            row("RT_Coil", &["RtCoil", "ResetTimer", "RT", "CoilRT", "ResetIECTimerCoil", "ResetIECTimer", "ResetTimerCoil", "RT_Coil"], &[], "in timer|operand ?>out", IN_OUT, ResetTimer),
            row("PT_Coil", &["PtCoil", "PresetTimer", "PT", "CoilPT", "PresetIECTimerCoil", "PresetIECTimer", "PresetTimerCoil", "PT_Coil"], &[], "in timer|operand pt|value ?>out", IN_OUT, PresetTimer),
            row("CTU", &["CTU"], &["CTU", "CTU_DINT", "CTU_UDINT", "CTU_LINT", "CTU_ULINT"], "?en cu ?r|reset pv ?>q ?>cv ?>eno", ("cu", "q"), Instance("CTU")),
            row("CTD", &["CTD"], &["CTD", "CTD_DINT", "CTD_UDINT", "CTD_LINT", "CTD_ULINT"], "?en cd ?ld|load pv ?>q ?>cv ?>eno", ("cd", "q"), Instance("CTD")),
            row("CTUD", &["CTUD"], &["CTUD", "CTUD_DINT", "CTUD_UDINT", "CTUD_LINT", "CTUD_ULINT"], "?en cu ?cd ?r|reset ?ld|load pv ?>qu ?>qd ?>cv ?>eno", ("cu", "qu"), Instance("CTUD")),
            en("CTRL_HSC", &["CTRL_HSC"], &[], "?en hsc ?dir ?cv ?rv ?period ?new_dir ?new_cv ?new_rv ?new_period ?>busy ?>status ?>eno", Instance("CTRL_HSC")),
            en("CTRL_HSC_EXT", &["CTRL_HSC_EXT"], &[], "?en hsc =ctrl ?>done ?>busy ?>error ?>status ?>eno", Instance("CTRL_HSC_EXT")),
        ],
    },
    Chapter {
        // Chapter B.4.
        title: "Math",
        source: "C.8, C.9",
        rows: &[
            en("Calculate", &["Calc", "Calculate"], &[], MANY, Calculate),
            // No file can use this name.
            en("function of IEC 61131-3", &[], &[], "?en in1|in+ ?>out ?>eno", Formula),
            en("Add", &["Add"], &["ADD"], MANY, Operator("+")),
            en("Sub", &["Sub"], &["SUB"], BINARY, Operator("-")),
            en("Mul", &["Mul"], &["MUL"], MANY, Operator("*")),
            en("Div", &["Div"], &["DIV"], BINARY, Operator("/")).eno(EnoRule::Division),
            en("Mod", &["Mod"], &["MOD"], BINARY, Operator("MOD")).eno(EnoRule::Division),
            en("Neg", &["Neg"], &[], UNARY, Negate),
            en("Abs", &["Abs"], &["ABS"], UNARY, Function("ABS")).follows_output().eno(EnoRule::Overflow),
            en("Inc", &["Inc", "INC"], &[], "?en =operand ?>eno", Step { up: true }),
            en("Dec", &["Dec"], &[], "?en =operand ?>eno", Step { up: false }),
            en("MIN", &["Min"], &["MIN"], MANY, Function("MIN")).follows_output(),
            en("MAX", &["Max"], &["MAX"], MANY, Function("MAX")).follows_output(),
            en("Limit", &["Limit"], &["LIMIT"], "?en mn|min in mx|max ?>out ?>eno", Function("LIMIT")).follows_output(),
            en("Sqr", &["Sqr"], &[], UNARY, Function("SQR")).eno(EnoRule::Infinite),
            en("Sqrt", &["Sqrt"], &["SQRT"], UNARY, Function("SQRT")).eno(EnoRule::Infinite),
            en("Ln", &["Ln"], &["LN"], UNARY, Function("LN")).eno(EnoRule::Infinite),
            en("Log", &["Log"], &["LOG"], UNARY, Function("LOG")).eno(EnoRule::Infinite),
            en("Exp", &["Exp"], &["EXP"], UNARY, Function("EXP")).eno(EnoRule::Infinite),
            en("Sin", &["Sin"], &["SIN"], UNARY, Function("SIN")).eno(EnoRule::Infinite),
            en("Cos", &["Cos"], &["COS"], UNARY, Function("COS")).eno(EnoRule::Infinite),
            en("Tan", &["Tan"], &["TAN"], UNARY, Function("TAN")).eno(EnoRule::Infinite),
            en("Asin", &["Asin"], &["ASIN"], UNARY, Function("ASIN")).eno(EnoRule::Infinite),
            en("Acos", &["Acos"], &["ACOS"], UNARY, Function("ACOS")).eno(EnoRule::Infinite),
            en("Atan", &["Atan"], &["ATAN"], UNARY, Function("ATAN")).eno(EnoRule::Infinite),
            en("Frac", &["Frac"], &[], UNARY, Function("FRAC")).eno(EnoRule::Infinite),
            en("Expt", &["Expt"], &["EXPT"], BINARY, Operator("**")),
        ],
    },
    Chapter {
        // Chapter B.5.
        title: "Move",
        source: "C.10",
        rows: &[
            en("Move", &["Move"], &["MOVE"], "?en in ?>out1|out+ ?>eno", Move),
            en("MoveBlockI", &["MoveBlockI", "MOVE_BLK", "MoveBlk"], &[], "?en in count >out ?>eno", Procedure("MOVE_BLK")).sd(&["MOVE_BLK"]),
            en("MoveBlockU", &["MoveBlockU", "UMOVE_BLK", "UMoveBlk"], &[], "?en in count >out ?>eno", Procedure("UMOVE_BLK")).sd(&["UMOVE_BLK"]),
            en("FillBlockI", &["FillBlockI", "FILL_BLK", "FillBlk"], &[], "?en in count >out ?>eno", Procedure("FILL_BLK")).sd(&["FILL_BLK"]),
            en("FillBlockU", &["FillBlockU", "UFILL_BLK", "UFillBlk"], &[], "?en in count >out ?>eno", Procedure("UFILL_BLK")).sd(&["UFILL_BLK"]),
            en("Swap", &["Swap"], &[], UNARY, Function("SWAP")).follows_output().eno(EnoRule::Never),
            en("MoveBlockVariant", &["MOVE_BLK_VARIANT", "MoveBlockVariant"], &[], "?en src count src_index|srcIndex dest_index|dstIndex ?>ret_val >dest|dst ?>eno", Procedure("MOVE_BLK_VARIANT")),
            en("S_Move", &["S_MOVE"], &[], "?en in >out ?>eno", Procedure("S_MOVE")),
            en("Serialize", &["Serialize"], &[], "?en src_variable|srcVariable =pos ?>ret_val >dest_array|dstArray ?>eno", Procedure("Serialize")),
            en("Deserialize", &["Deserialize"], &[], "?en src_array|srcArray =pos ?>ret_val >dest_variable|dstVariable ?>eno", Procedure("Deserialize")),
            en("GATHER", &["GATHER", "Gather"], &[], "?en in >out ?>eno", Procedure("GATHER")),
            en("SCATTER", &["SCATTER", "Scatter"], &[], "?en in >out ?>eno", Procedure("SCATTER")),
            en("GatherBlock", &["GATHER_BLK", "GatherBlock"], &[], "?en in count_out|countOut >out ?>eno", Procedure("GATHER_BLK")),
            en("ScatterBlock", &["SCATTER_BLK", "ScatterBlock"], &[], "?en in count_in|countIn >out ?>eno", Procedure("SCATTER_BLK")),
            en("VariantGet", &["VariantGet"], &[], "?en src >dst ?>eno", Procedure("VariantGet")),
            en("VariantPut", &["VariantPut"], &[], "?en src dst ?>eno", Procedure("VariantPut")),
            en("CountOfElements", &["CountOfElements"], &[], "?en in ?>out|ret_val ?>eno", Function("CountOfElements")).own_types(),
            en("Lower_Bound", &["LOWER_BOUND"], &[], "?en arr dim ?>out ?>eno", Function("LOWER_BOUND")).own_types(),
            en("Upper_Bound", &["UPPER_BOUND"], &[], "?en arr dim ?>out ?>eno", Function("UPPER_BOUND")).own_types(),
        ],
    },
    Chapter {
        // Chapter B.6.
        title: "Conversion",
        source: "C.11",
        rows: &[
            en("Convert", &["Convert", "CONV"], &[], UNARY, Convert),
            en("Round", &["Round"], &[], UNARY, Round("ROUND")),
            en("Trunc", &["Trunc"], &["TRUNC"], UNARY, Round("TRUNC")),
            en("Ceil", &["Ceil"], &[], UNARY, Round("CEIL")),
            en("Floor", &["Floor"], &[], UNARY, Round("FLOOR")),
            en("Scale", &["Scale_X", "ScaleX", "SCALE_X"], &[], "?en min value max ?>out ?>eno", Function("SCALE_X")).sd(&["Scale_X"]).output_pins(&["min", "max"]).named_by_output(),
            en("Normalize", &["Normalize", "Norm_X", "NORM_X", "Norm"], &[], "?en min value max ?>out ?>eno", Function("NORM_X")).sd(&["Norm_X"]).named_by_output(),
        ],
    },
    Chapter {
        // Chapter B.7.
        title: "Program control",
        source: "C.12, C.18",
        rows: &[
            row("JumpCoil", &["Jump", "JMP", "JumpCoil", "JumpTrue"], &[], "?in label", ("in", ""), Jump { negated: false }),
            row("I_JumpCoil", &["JumpNot", "JumpN", "JMPN", "JumpNotCoil", "I_JumpCoil", "JumpFalse"], &[], "?in label", ("in", ""), Jump { negated: true }),
            row("JumpList", &["JmpList", "JMP_LIST"], &[], "?en k ?>dest0|dst0+", ("en", ""), JumpList),
            row("Switch", &["Switch"], &[], "?en k ?case0+ ?>dest0|dst0+ ?>else|default", ("en", ""), Switch),
            row("ReturnCoil", &["Return", "Ret", "ReturnValue", "ReturnCoil", "RetCoil"], &[], "?in ?operand", ("in", ""), Return(ReturnValue::Operand)).sd(&["Return"]),
            row("ReturnTrue", &["ReturnTrue", "RetTrue", "ReturnTrueCoil"], &[], "?in", ("in", ""), Return(ReturnValue::True)),
            row("ReturnFalse", &["ReturnFalse", "RetFalse", "ReturnFalseCoil"], &[], "?in", ("in", ""), Return(ReturnValue::False)),
            en("RE_TRIGR", &["RE_TRIGR"], &[], "?en ?>eno", Procedure("RE_TRIGR")),
            en("STP", &["STP"], &[], "?en ?>eno", Procedure("STP")),
            en("WAIT", &["WAIT"], &[], "?en wt ?>eno", Procedure("WAIT")),
            en("GetError", &["GetError", "GET_ERROR"], &[], "?en >error|out ?>eno", Procedure("GET_ERROR")),
            en("GetErrorID", &["GetErrorID", "GET_ERR_ID"], &[], "?en ?>out|id|error ?>eno", Function("GET_ERR_ID")).own_types(),
            en("Runtime", &["RUNTIME"], &[], "?en =mem ?>out|ret_val ?>eno", Function("RUNTIME")).own_types(),
        ],
    },
    Chapter {
        // Chapter B.8.
        title: "Word logic, selection, shift",
        source: "C.13, C.14",
        rows: &[
            en("And", &["And"], &[], MANY, Operator("AND")).eno(EnoRule::Never),
            en("Or", &["Or"], &[], MANY, Operator("OR")).eno(EnoRule::Never),
            en("Xor", &["Xor"], &[], MANY, Operator("XOR")).eno(EnoRule::Never),
            en("Inv", &["Inv", "Invert"], &[], UNARY, Invert),
            en("BITSUM", &["BITSUM", "BitSum"], &[], UNARY, Function("BITSUM")),
            en("ENCO", &["ENCO", "Encode"], &[], UNARY, Function("ENCO")),
            en("DECO", &["DECO", "Decode"], &[], UNARY, Function("DECO")).named_by_output().eno(EnoRule::Never),
            en("SEL", &["Sel", "Select"], &["SEL"], "?en g in0 in1 ?>out ?>eno", Function("SEL")).own_pins(&["g"]).follows_output().eno(EnoRule::Never),
            en("Mux", &["Mux", "Multiplex"], &["MUX"], "?en k in0+ ?else|inelse ?>out ?>eno", Mux),
            en("Demux", &["Demux", "Demultiplex"], &[], "?en k in ?>out0+ ?>else|outelse ?>eno", Demux),
            en("Shr", &["Shr"], &["SHR"], SHIFT, Function("SHR")).own_pins(&["n"]).follows_output().eno(EnoRule::Never),
            en("Shl", &["Shl"], &["SHL"], SHIFT, Function("SHL")).own_pins(&["n"]).follows_output().eno(EnoRule::Never),
            en("Ror", &["Ror"], &["ROR"], SHIFT, Function("ROR")).own_pins(&["n"]).follows_output().eno(EnoRule::Never),
            en("Rol", &["Rol"], &["ROL"], SHIFT, Function("ROL")).own_pins(&["n"]).follows_output().eno(EnoRule::Never),
        ],
    },
    Chapter {
        // Chapter B.9.
        title: "Dates, texts, interrupts, communication, controllers",
        source: "C.15 to C.17, C.19 to C.21",
        rows: &[
            en("T_CONV", &["T_CONV"], &[], UNARY, Function("T_CONV")).own_types(),
            en("T_ADD", &["T_ADD"], &[], BINARY, Function("T_ADD")).own_types(),
            en("T_SUB", &["T_SUB"], &[], BINARY, Function("T_SUB")).own_types(),
            en("T_DIFF", &["T_DIFF"], &[], BINARY, Function("T_DIFF")).own_types(),
            en("T_COMBINE", &["T_COMBINE"], &[], BINARY, Function("T_COMBINE")).own_types(),
            en("WR_SYS_T", &["WR_SYS_T"], &[], "?en in ?>ret_val ?>eno", Procedure("WR_SYS_T")),
            en("RD_SYS_T", &["RD_SYS_T"], &[], "?en ?>ret_val >out ?>eno", Procedure("RD_SYS_T")),
            en("RD_LOC_T", &["RD_LOC_T"], &[], "?en ?>ret_val >out ?>eno", Procedure("RD_LOC_T")),
            en("WR_LOC_T", &["WR_LOC_T"], &[], "?en loctime dst ?>ret_val ?>eno", Procedure("WR_LOC_T")),
            en("S_CONV", &["S_CONV"], &[], "?en in >out ?>eno", Procedure("S_CONV")),
            en("StringToValue", &["STRG_VAL", "StringToValue"], &[], "?en in format =p >out ?>eno", Procedure("STRG_VAL")).sd(&["STRG_VAL"]),
            en("ValueToString", &["VAL_STRG", "ValueToString"], &[], "?en in size prec format =p >out ?>eno", Procedure("VAL_STRG")).sd(&["VAL_STRG"]),
            en("Strg_TO_Chars", &["Strg_TO_Chars"], &[], "?en strg pchars ?>cnt =chars ?>eno", Procedure("Strg_TO_Chars")),
            en("Chars_TO_Strg", &["Chars_TO_Strg"], &[], "?en chars pchars cnt >strg ?>eno", Procedure("Chars_TO_Strg")),
            en("AsciiToHex", &["ATH", "AsciiToHex"], &[], "?en in n ?>ret_val >out ?>eno", Procedure("ATH")).sd(&["ATH"]),
            en("HexToAscii", &["HTA", "HexToAscii"], &[], "?en in n ?>ret_val >out ?>eno", Procedure("HTA")).sd(&["HTA"]),
            en("LEN", &["LEN"], &["LEN"], UNARY, Function("LEN")).own_types(),
            en("MaxLen", &["MAX_LEN", "MaxLen"], &[], UNARY, Function("MAX_LEN")).sd(&["MAX_LEN"]).own_types(),
            en("CONCAT", &["CONCAT"], &["CONCAT"], MANY, Function("CONCAT")).own_types(),
            en("LEFT", &["LEFT"], &["LEFT"], "?en in l ?>out ?>eno", Function("LEFT")).own_types(),
            en("RIGHT", &["RIGHT"], &["RIGHT"], "?en in l ?>out ?>eno", Function("RIGHT")).own_types(),
            en("MID", &["MID"], &["MID"], "?en in l p ?>out ?>eno", Function("MID")).own_types(),
            en("DELETE", &["DELETE"], &["DELETE"], "?en in l p ?>out ?>eno", Function("DELETE")).own_types(),
            en("INSERT", &["INSERT"], &["INSERT"], "?en in1 in2 p ?>out ?>eno", Function("INSERT")).own_types(),
            en("REPLACE", &["REPLACE"], &["REPLACE"], "?en in1 in2 l p ?>out ?>eno", Function("REPLACE")).own_types(),
            en("FIND", &["FIND"], &["FIND"], BINARY, Function("FIND")).own_types(),
            en("ATTACH", &["ATTACH"], &[], "?en ob_nr event ?add ?>ret_val ?>eno", Procedure("ATTACH")),
            en("DETACH", &["DETACH"], &[], "?en ob_nr ?event ?>ret_val ?>eno", Procedure("DETACH")),
            en("SET_CINT", &["SET_CINT"], &[], "?en ob_nr cycle phase ?>ret_val ?>eno", Procedure("SET_CINT")),
            en("QRY_CINT", &["QRY_CINT"], &[], "?en ob_nr ?>ret_val ?>cycle ?>phase ?>status ?>eno", Procedure("QRY_CINT")),
            en("SRT_DINT", &["SRT_DINT"], &[], "?en ob_nr dtime sign ?>ret_val ?>eno", Procedure("SRT_DINT")),
            en("CAN_DINT", &["CAN_DINT"], &[], "?en ob_nr ?>ret_val ?>eno", Procedure("CAN_DINT")),
            en("QRY_DINT", &["QRY_DINT"], &[], "?en ob_nr ?>ret_val ?>status ?>eno", Procedure("QRY_DINT")),
            en("DIS_AIRT", &["DIS_AIRT"], &[], "?en ?>ret_val ?>eno", Procedure("DIS_AIRT")),
            en("EN_AIRT", &["EN_AIRT"], &[], "?en ?>ret_val ?>eno", Procedure("EN_AIRT")),
            en("SET_TIMEZONE", &["SET_TIMEZONE"], &[], "?en ?req ?timezone ?>done ?>busy ?>error ?>status ?>eno", Instance("SET_TIMEZONE")),
            en("RTM", &["RTM"], &[], "?en nr mode ?pv ?>ret_val ?>cq ?>cv ?>eno", Procedure("RTM")),
            en("CTRL_PWM", &["CTRL_PWM"], &[], "?en pwm enable ?>busy ?>status ?>eno", Instance("CTRL_PWM")),
            en("TSEND_C", &["TSEND_C"], &[], "?en ?req ?cont ?len =connect =data ?addr ?com_rst ?>done ?>busy ?>error ?>status ?>eno", Instance("TSEND_C")),
            en("TRCV_C", &["TRCV_C"], &[], "?en ?en_r ?cont ?len ?adhoc =connect =data ?addr ?com_rst ?>done ?>busy ?>error ?>status ?>rcvd_len ?>eno", Instance("TRCV_C")),
            en("TCON", &["TCON"], &[], "?en req id =connect ?>done ?>busy ?>error ?>status ?>eno", Instance("TCON")),
            en("TDISCON", &["TDISCON"], &[], "?en req id ?>done ?>busy ?>error ?>status ?>eno", Instance("TDISCON")),
            en("TSEND", &["TSEND"], &[], "?en req id ?len =data ?addr ?>done ?>busy ?>error ?>status ?>eno", Instance("TSEND")),
            en("TRCV", &["TRCV"], &[], "?en en_r id ?len ?adhoc =data ?addr ?>ndr ?>busy ?>error ?>status ?>rcvd_len ?>eno", Instance("TRCV")),
            en("PID_Compact", &["PID_Compact"], &[],
                "?en ?setpoint ?input ?input_per ?disturbance ?manualenable ?manualvalue ?errorack ?reset ?modeactivate ?=mode ?>scaledinput ?>output ?>output_per ?>output_pwm ?>setpointlimit_h ?>setpointlimit_l ?>inputwarning_h ?>inputwarning_l ?>state ?>error ?>errorbits ?>eno",
                Instance("PID_Compact")),
            en("PID_3Step", &["PID_3Step"], &[],
                "?en ?setpoint ?input ?input_per ?actuator_h ?actuator_l ?feedback ?feedback_per ?disturbance ?manualenable ?manualvalue ?manual_up ?manual_dn ?errorack ?reset ?modeactivate ?=mode ?>scaledinput ?>scaledfeedback ?>output_up ?>output_dn ?>output_per ?>setpointlimit_h ?>setpointlimit_l ?>inputwarning_h ?>inputwarning_l ?>state ?>error ?>errorbits ?>eno",
                Instance("PID_3Step")),
        ],
    },
    Chapter {
        title: "Motion control",
        source: "motion control",
        rows: &[
            en("MC_Power", &["MC_Power"], &[],
                "?en =axis ?enable ?startmode ?stopmode ?>status ?>busy ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_Power")),
            en("MC_Reset", &["MC_Reset"], &[],
                "?en =axis ?execute ?restart ?>done ?>busy ?>commandaborted ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_Reset")),
            en("MC_Home", &["MC_Home"], &[],
                "?en =axis ?execute ?position ?mode ?>done ?>busy ?>active ?>commandaborted ?>error ?>errorid ?>errorinfo ?>referencemarkposition ?>eno",
                Instance("MC_Home")),
            en("MC_Halt", &["MC_Halt"], &[],
                "?en =axis ?execute ?deceleration ?jerk ?abortacceleration ?>done ?>busy ?>active ?>commandaborted ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_Halt")),
            en("MC_MoveAbsolute", &["MC_MoveAbsolute"], &[],
                "?en =axis ?execute ?position ?velocity ?acceleration ?deceleration ?jerk ?direction ?>done ?>busy ?>active ?>commandaborted ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_MoveAbsolute")),
            en("MC_MoveRelative", &["MC_MoveRelative"], &[],
                "?en =axis ?execute ?distance ?velocity ?acceleration ?deceleration ?jerk ?>done ?>busy ?>active ?>commandaborted ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_MoveRelative")),
            en("MC_MoveVelocity", &["MC_MoveVelocity"], &[],
                "?en =axis ?execute ?velocity ?acceleration ?deceleration ?jerk ?direction ?current ?positioncontrolled ?>invelocity ?>busy ?>active ?>commandaborted ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_MoveVelocity")),
            en("MC_MoveJog", &["MC_MoveJog"], &[],
                "?en =axis ?jogforward ?jogbackward ?velocity ?acceleration ?deceleration ?jerk ?positioncontrolled ?>invelocity ?>busy ?>active ?>commandaborted ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_MoveJog")),
            en("MC_ChangeDynamic", &["MC_ChangeDynamic"], &[],
                "?en =axis ?execute ?changerampup ?rampuptime ?changerampdown ?rampdowntime ?changeemergency ?emergencyramptime ?changejerktime ?jerktime ?>done ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_ChangeDynamic")),
            en("MC_ReadParam", &["MC_ReadParam"], &[],
                "?en enable parameter =value ?>valid ?>busy ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_ReadParam")),
            en("MC_WriteParam", &["MC_WriteParam"], &[],
                "?en execute paramname value ?>done ?>busy ?>error ?>errorid ?>errorinfo ?>eno",
                Instance("MC_WriteParam")),
        ],
    },
    Chapter {
        // Chapter B.10.
        title: "S7-300/400",
        source: "B.10, C.22",
        rows: &[
            row("S_PULSE", &["S_PULSE", "Sp", "SP_Coil", "CoilSP", "SPulse", "SpCoil"], &[], S5_TIMER, ("s", "q"), S5Timer("S_PULSE")).sd(&["SP_Coil"]),
            row("S_PEXT", &["S_PEXT", "Se", "SE_Coil", "CoilSE", "SPext", "SeCoil"], &[], S5_TIMER, ("s", "q"), S5Timer("S_PEXT")).sd(&["SE_Coil"]),
            row("S_ODT", &["S_ODT", "Sd", "SD_Coil", "CoilSD", "SOdt", "SdCoil"], &[], S5_TIMER, ("s", "q"), S5Timer("S_ODT")).sd(&["SD_Coil"]),
            row("S_ODTS", &["S_ODTS", "Ss", "SS_Coil", "CoilSS", "SOdts", "SsCoil"], &[], S5_TIMER, ("s", "q"), S5Timer("S_ODTS")).sd(&["SS_Coil"]),
            row("S_OFFDT", &["S_OFFDT", "Sf", "SF_Coil", "CoilSF", "SOffdt", "SfCoil"], &[], S5_TIMER, ("s", "q"), S5Timer("S_OFFDT")).sd(&["SF_Coil"]),
            row("S_Cud", &["S_CUD", "SCud"], &[], S5_COUNTER, ("cu", "q"), S5Counter("S_CUD")),
            row("S_Cu", &["S_CU", "SCu"], &[], S5_COUNTER, ("cu", "q"), S5Counter("S_CU")),
            row("S_Cd", &["S_CD", "SCd"], &[], S5_COUNTER, ("cd", "q"), S5Counter("S_CD")),
            row("CU_Coil", &["CU", "CoilCU", "CuCoil", "CU_Coil"], &[], "in ?counter|operand ?>out", IN_OUT, CountCoil(CounterCoil::Up)),
            row("CD_Coil", &["CD", "CoilCD", "CdCoil", "CD_Coil"], &[], "in ?counter|operand ?>out", IN_OUT, CountCoil(CounterCoil::Down)),
            row("SC_Coil", &["SC", "CoilSC", "ScCoil", "SC_Coil"], &[], "in ?counter|operand pv|value ?>out", IN_OUT, CountCoil(CounterCoil::Set)),
            row("OpenDBCoil", &["OPN", "OpenDB", "OpenDBCoil"], &[], "?in operand", ("in", ""), OpenDb { di: false }),
            row("OpenDICoil", &["OPNI", "OpenDI", "OpenDICoil"], &[], "?in operand", ("in", ""), OpenDb { di: true }),
            row("McrActivateCoil", &["MCRA", "McrActivate", "McrActivateCoil"], &[], "?in", ("in", ""), McrCoil(Mcr::Activate)),
            row("McrOpenCoil", &["MCR<", "McrOpen", "MCR_Open", "McrOpenCoil", "McrBegin"], &[], "?in", ("in", ""), McrCoil(Mcr::Open)),
            row("McrCloseCoil", &["MCR>", "McrClose", "MCR_Close", "McrCloseCoil", "McrEnd"], &[], "?in", ("in", ""), McrCoil(Mcr::Close)),
            row("McrDeactivateCoil", &["MCRD", "McrDeactivate", "McrDeactivateCoil"], &[], "?in", ("in", ""), McrCoil(Mcr::Deactivate)),
            row("CallCoil", &["CallCoil", "CALL"], &[], "?in operand", ("in", ""), CallCoil),
            row("SaveCoil", &["Save", "SaveCoil"], &[], "in ?>out", IN_OUT, Save),
            row("ConditionCoil", &["TrCoil", "IlCoil", "SvCoil"], &[], "in", ("in", ""), Condition),
            row("OV_FlagContact", &["OV", "OvContact"], &[], FLAG, PRE, StatusFlag(Flag::Ov)),
            row("OS_FlagContact", &["OS", "OsContact"], &[], FLAG, PRE, StatusFlag(Flag::Os)),
            row("UO_FlagContact", &["UO", "UoContact"], &[], FLAG, PRE, StatusFlag(Flag::Uo)),
            row("BR_FlagContact", &["BR", "BrContact"], &[], FLAG, PRE, StatusFlag(Flag::Br)),
            row("EQ_I_Flags_Contact", &["==0"], &[], FLAG, PRE, StatusFlag(Flag::Equal)).sd(&["EQ_I_Flags_Contract"]),
            row("NE_I_Flags_Contact", &["<>0"], &[], FLAG, PRE, StatusFlag(Flag::NotEqual)).sd(&["NE_I_Flags_Contract"]),
            row("GT_I_Flags_Contact", &[">0"], &[], FLAG, PRE, StatusFlag(Flag::Greater)).sd(&["GT_I_Flags_Contract"]),
            row("LT_I_Flags_Contact", &["<0"], &[], FLAG, PRE, StatusFlag(Flag::Less)).sd(&["LT_I_Flags_Contract"]),
            row("GE_I_Flags_Contact", &[">=0"], &[], FLAG, PRE, StatusFlag(Flag::GreaterEqual)).sd(&["GE_I_Flags_Contract"]),
            row("LE_I_Flags_Contact", &["<=0"], &[], FLAG, PRE, StatusFlag(Flag::LessEqual)).sd(&["LE_I_Flags_Contract"]),
        ],
    },
];
