//! Networks of LAD, one for each element that is not a function of SCL under another name.

use plcc_syntax::network::elements::{Kind, elements};

use super::Row;

/// Element, template, and what follows the power rail.
#[rustfmt::skip]
const SEQUENCES: &[(&str, &str)] = &[
    ("Contact", "Contact( D.b1 ) Coil( D.bo )"),
    ("Not", "Contact( D.b1 ) Not() Coil( D.bo )"),
    ("P_Contact", "P_Contact( operand := D.b1, bit := %M{p}.0 ) Coil( D.bo )"),
    ("N_Contact", "N_Contact( operand := D.b1, bit := %M{p}.0 ) Coil( D.bo )"),
    ("P_Trig", "Contact( D.b1 ) P_Trig( %M{p}.0 ) Coil( D.bo )"),
    ("N_Trig", "Contact( D.b1 ) N_Trig( %M{p}.0 ) Coil( D.bo )"),
    ("R_TRIG", "\"X{n}\".R_TRIG( clk := D.b1, q => D.bo )"),
    ("F_TRIG", "\"X{n}\".F_TRIG( clk := D.b1, q => D.bo )"),
    ("Coil", "Contact( D.b1 ) Coil( D.bo )"),
    ("S_Coil", "Contact( D.b1 ) S_Coil( D.bo )"),
    ("R_Coil", "Contact( D.b1 ) R_Coil( D.bo )"),
    ("P_Coil", "Contact( D.b1 ) P_Coil( operand => D.bo, bit := %M{p}.0 )"),
    ("N_Coil", "Contact( D.b1 ) N_Coil( operand => D.bo, bit := %M{p}.0 )"),
    ("S_BitfieldCoil", "Contact( D.b1 ) S_BitfieldCoil( operand => D.f[3], n := 4 )"),
    ("R_BitfieldCoil", "Contact( D.b1 ) R_BitfieldCoil( operand => D.f[3], n := 4 )"),
    ("S_SR", "Contact( D.b1 ) S_SR( operand := D.e0, r1 := D.b2 ) Coil( D.bo )"),
    ("S_RS", "Contact( D.b1 ) S_RS( operand := D.e0, s1 := D.b2 ) Coil( D.bo )"),
    ("EQ", "{SrcType := Int} EQ_Contact( in1 := D.i1, in2 := D.i2 ) Coil( D.bo )"),
    ("NE", "{SrcType := Int} NE_Contact( in1 := D.i1, in2 := D.i2 ) Coil( D.bo )"),
    ("GE", "{SrcType := Int} GE_Contact( in1 := D.i1, in2 := D.i2 ) Coil( D.bo )"),
    ("LE", "{SrcType := Int} LE_Contact( in1 := D.i1, in2 := D.i2 ) Coil( D.bo )"),
    ("GT", "{SrcType := Real} GT_Contact( in1 := D.r1, in2 := D.r2 ) Coil( D.bo )"),
    ("LT", "{SrcType := Real} LT_Contact( in1 := D.r1, in2 := D.r2 ) Coil( D.bo )"),
    ("InRange", "{SrcType := Real} InRange( min := 1.0, in := D.r1, max := D.r2 ) Coil( D.bo )"),
    ("OutRange", "{SrcType := Real} OutRange( min := 1.0, in := D.r1, max := D.r2 ) Coil( D.bo )"),
    ("TP", "Contact( D.b1 ) {time_type := Time} \"X{n}\".TP( pt := T#100ms, et => ) Coil( D.bo )"),
    ("TON", "Contact( D.b1 ) {time_type := Time} \"X{n}\".TON( pt := T#100ms, et => ) Coil( D.bo )"),
    ("TOF", "Contact( D.b1 ) {time_type := Time} \"X{n}\".TOF( pt := T#100ms, et => ) Coil( D.bo )"),
    ("TONR", "Contact( D.b1 ) {time_type := Time} \"X{n}\".TONR( r := D.b2, pt := T#100ms, et => ) Coil( D.bo )"),
    ("TP_Coil", "Contact( D.b1 ) {time_type := Time} TP_Coil( timer => \"X{n}\", pt := T#100ms )"),
    ("TON_Coil", "Contact( D.b1 ) {time_type := Time} TON_Coil( timer => \"X{n}\", pt := T#100ms )"),
    ("TOF_Coil", "Contact( D.b1 ) {time_type := Time} TOF_Coil( timer => \"X{n}\", pt := T#100ms )"),
    ("TONR_Coil", "Contact( D.b1 ) {time_type := Time} TONR_Coil( timer => \"X{n}\", pt := T#100ms )"),
    ("RT_Coil", "Contact( D.b1 ) RT_Coil( \"X{n}\" )"),
    ("PT_Coil", "Contact( D.b1 ) PT_Coil( timer => \"X{n}\", PT := T#200ms )"),
    ("CTU", "Contact( D.b1 ) {value_type := Int} \"X{n}\".CTU( r := D.b2, pv := 9, cv => ) Coil( D.bo )"),
    ("CTD", "Contact( D.b1 ) {value_type := Int} \"X{n}\".CTD( ld := D.b2, pv := 9, cv => ) Coil( D.bo )"),
    ("CTUD", "Contact( D.b1 ) {value_type := Int} \"X{n}\".CTUD( cd := D.b2, r := FALSE, ld := FALSE, pv := 9, qd => , cv => ) Coil( D.bo )"),
    ("Calculate", "Contact( D.b1 ) {SrcType := Real|S7_Expression := \"IN1 * (IN2 + 1.0)\"} Calculate( in1 := D.r1, in2 := D.r2, out => D.ro )"),
    ("Add", "Contact( D.b1 ) {SrcType := Int|S7_GenerateENO := \"TRUE\"} Add( in1 := D.i1, in2 := D.i2, out => D.io ) Coil( D.bo )"),
    ("Sub", "Contact( D.b1 ) {SrcType := Int|S7_GenerateENO := \"TRUE\"} Sub( in1 := D.i1, in2 := D.i2, out => D.io ) Coil( D.bo )"),
    ("Mul", "Contact( D.b1 ) {SrcType := Int|S7_GenerateENO := \"TRUE\"} Mul( in1 := D.i1, in2 := D.i2, out => D.io ) Coil( D.bo )"),
    ("Div", "Contact( D.b1 ) {SrcType := Int|S7_GenerateENO := \"TRUE\"} Div( in1 := D.i1, in2 := D.i2, out => D.io ) Coil( D.bo )"),
    ("Mod", "Contact( D.b1 ) {SrcType := Int|S7_GenerateENO := \"TRUE\"} Mod( in1 := D.i1, in2 := D.i2, out => D.io ) Coil( D.bo )"),
    ("Neg", "Contact( D.b1 ) {SrcType := Int} Neg( in := D.i1, out => D.io )"),
    ("Inc", "Contact( D.b1 ) {DestType := Int} Inc( D.i3 )"),
    ("Dec", "Contact( D.b1 ) {DestType := Int} Dec( D.i3 )"),
    ("Move", "Contact( D.b1 ) Move( in := D.i1, out1 => D.io )"),
    ("Convert", "Contact( D.b1 ) {SrcType := Int, DestType := Real} Convert( in := D.i1, out => D.ro )"),
    ("Round", "Contact( D.b1 ) {SrcType := Real, DestType := DInt} Round( in := D.r1, out => D.do )"),
    ("Trunc", "Contact( D.b1 ) {SrcType := Real, DestType := DInt} Trunc( in := D.r1, out => D.do )"),
    ("Ceil", "Contact( D.b1 ) {SrcType := Real, DestType := DInt} Ceil( in := D.r1, out => D.do )"),
    ("Floor", "Contact( D.b1 ) {SrcType := Real, DestType := DInt} Floor( in := D.r1, out => D.do )"),
    ("ReturnCoil", "Contact( D.b1 ) ReturnCoil( TRUE )"),
    ("And", "Contact( D.b1 ) {SrcType := Word} And( in1 := D.w1, in2 := 16#0FF0, out => D.wo )"),
    ("Or", "Contact( D.b1 ) {SrcType := Word} Or( in1 := D.w1, in2 := 16#0FF0, out => D.wo )"),
    ("Xor", "Contact( D.b1 ) {SrcType := Word} Xor( in1 := D.w1, in2 := 16#0FF0, out => D.wo )"),
    ("Inv", "Contact( D.b1 ) {SrcType := Word} Inv( in := D.w1, out => D.wo )"),
    ("Mux", "Contact( D.b1 ) {value_type := Int} Mux( k := D.k, in0 := D.i1, in1 := D.i2, else := 7, out => D.io )"),
    ("Demux", "Contact( D.b1 ) {value_type := Int} Demux( k := D.k, in := D.i1, out0 => D.io, out1 => D.i3, else => D.i4 )"),
    ("SP_Coil", "Contact( D.b1 ) SP_Coil( timer => %T{n}, pt := S5T#100ms )"),
    ("S_PULSE", "Contact( D.b1 ) S_PULSE( timer := %T{n}, tv := S5T#100ms, r := FALSE, bi => , bcd => ) Coil( D.bo )"),
    ("S_ODT", "Contact( D.b1 ) S_ODT( timer := %T{n}, tv := S5T#100ms, r := FALSE, bi => D.wo, bcd => ) Coil( D.bo )"),
    ("CU_Coil", "Contact( D.b1 ) CU_Coil( %C{n} )"),
    ("CD_Coil", "Contact( D.b1 ) CD_Coil( %C{n} )"),
    ("SC_Coil", "Contact( D.b1 ) SC_Coil( counter => %C{n}, pv := 16#5 )"),
];

/// Elements that are called as a function of SCL or as a block of the library, whose rows and tests are there; `S7-300` elements without a word
/// in SIMATIC SD; jumps, which need a second network.
pub fn has_sequence_elsewhere(name: &str) -> bool {
    elements().find(|row| row.name == name).is_some_and(|row| {
        matches!(
            row.kind,
            Kind::Function(_)
                | Kind::Procedure(_)
                | Kind::Instance(_)
                | Kind::Formula
                | Kind::Operator(_)
                | Kind::Gate(_)
                | Kind::Valid { .. }
                | Kind::Variant(_)
                | Kind::Jump { .. }
                | Kind::JumpList
                | Kind::Switch
                | Kind::Return(_)
                | Kind::S5Timer(_)
                | Kind::S5Counter(_)
                | Kind::OpenDb { .. }
                | Kind::Mcr(_)
                | Kind::CallCoil
                | Kind::Save
                | Kind::Condition
                | Kind::Flag(_)
        )
    })
}

/// All sequences.
pub fn rows() -> Vec<Row> {
    SEQUENCES.iter().map(|(name, sequence)| Row::new("LAD", name, sequence)).collect()
}

/// The data block of a timer, a counter or an edge that a sequence uses, by its element.
fn instance(sequence: &str) -> Option<&'static str> {
    let types = [
        (".R_TRIG(", "R_TRIG"),
        (".F_TRIG(", "F_TRIG"),
        (".TP(", "TP_TIME"),
        (".TON(", "TON_TIME"),
        (".TOF(", "TOF_TIME"),
        (".TONR(", "TONR_TIME"),
        ("TP_Coil(", "TP_TIME"),
        ("TONR_Coil(", "TONR_TIME"),
        ("TON_Coil(", "TON_TIME"),
        ("TOF_Coil(", "TOF_TIME"),
        ("RT_Coil(", "TON_TIME"),
        ("PT_Coil(", "TON_TIME"),
        (".CTUD(", "CTUD_INT"),
        (".CTU(", "CTU_INT"),
        (".CTD(", "CTD_INT"),
    ];
    types.into_iter().find(|(word, _)| sequence.contains(word)).map(|(_, ty)| ty)
}

/// A CPU that runs the networks, and the sources with their functions.
pub fn sources(blocks: Vec<(usize, String)>, main: String) -> (&'static str, Vec<(&'static str, String)>) {
    let (mut text, mut data) = (String::new(), super::scl::DATA.to_string());
    for (number, sequence) in [(1, String::new())].into_iter().chain(blocks) {
        if let Some(ty) = instance(&sequence) {
            // `X{n}` counts from the first row.
            data.push_str(&format!("DATA_BLOCK \"X{}\"\n{ty}\nBEGIN\nEND_DATA_BLOCK\n", number - 2));
        }
        text.push_str(&format!("FUNCTION R{number} : Void\n"));
        if !sequence.is_empty() {
            let rungs = attributes(&sequence.replace("D.", "\"D\"."));
            text.push_str(&format!(
                "    {{ S7_Language := \"LAD\" }}\n    NETWORK\n        RUNG wire#powerrail {rungs} END_RUNG\n    END_NETWORK\n"
            ));
        }
        text.push_str("END_FUNCTION\n");
    }
    ("s7-1500", vec![("costs.s7dcl", text), ("data.scl", data), ("main.stl", main)])
}

/// `{SrcType := Int|S7_GenerateENO := "TRUE"}` as SIMATIC SD has it: the templates between quotation marks, then other attributes.
fn attributes(sequence: &str) -> String {
    let mut text = String::new();
    let mut rest = sequence;
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, after) = after.split_once('}').expect("the brackets are written in pairs");
        let (templates, others) =
            inside.split_once('|').map_or((inside, String::new()), |(t, o)| (t, format!("; {o}")));
        let templates = if templates.contains(',') { format!("[{templates}]") } else { templates.to_string() };
        text.push_str(&format!("{before}{{ S7_Templates := \"{templates}\"{others} }}"));
        rest = after;
    }
    text + rest
}
