//! Boxes of the S7-200 as Micro/WIN draws them: the title, and which operand of the statement is at which pin.
//!
//! Source: S7-200 system manual, LAD and FBD forms of the instructions.

/// A box.
pub struct Face {
    pub title: String,
    /// The relation that TBL_FIND looks for, below the title.
    pub detail: String,
    pub pins: Vec<Pin>,
}

/// A pin of a box.
pub struct Pin {
    pub name: &'static str,
    pub output: bool,
    /// Which operand of the statement; one that is changed in place is at two pins.
    pub operand: usize,
}

/// Title and pins by the mnemonic: a number is the operand, `>` an output. `+I 5, VW0` adds to VW0, which is input and output.
const ROWS: &[(&str, &str, &str)] = &[
    ("BIR", "MOV_BIR", "IN0 >OUT1"),
    ("BIW", "MOV_BIW", "IN0 >OUT1"),
    ("SWAP", "SWAP", "IN0"),
    ("MUL", "MUL", "IN1=0 IN2=1 >OUT1"),
    ("DIV", "DIV", "IN1=1 IN2=0 >OUT1"),
    ("BTI", "B_I", "IN0 >OUT1"),
    ("ITB", "I_B", "IN0 >OUT1"),
    ("ITD", "I_DI", "IN0 >OUT1"),
    ("DTI", "DI_I", "IN0 >OUT1"),
    ("DTR", "DI_R", "IN0 >OUT1"),
    ("BCDI", "BCD_I", "IN0 >OUT0"),
    ("IBCD", "I_BCD", "IN0 >OUT0"),
    ("ITA", "ITA", "IN0 FMT2 >OUT1"),
    ("DTA", "DTA", "IN0 FMT2 >OUT1"),
    ("RTA", "RTA", "IN0 FMT2 >OUT1"),
    ("ATH", "ATH", "IN0 LEN2 >OUT1"),
    ("HTA", "HTA", "IN0 LEN2 >OUT1"),
    ("ITS", "I_S", "IN0 FMT2 >OUT1"),
    ("DTS", "DI_S", "IN0 FMT2 >OUT1"),
    ("RTS", "R_S", "IN0 FMT2 >OUT1"),
    ("STI", "S_I", "IN0 INDX1 >OUT2"),
    ("STD", "S_DI", "IN0 INDX1 >OUT2"),
    ("STR", "S_R", "IN0 INDX1 >OUT2"),
    ("SLEN", "STR_LEN", "IN0 >OUT1"),
    ("SCPY", "STR_CPY", "IN0 >OUT1"),
    ("SCAT", "STR_CAT", "IN0 >OUT1"),
    ("SSCPY", "SSTR_CPY", "IN0 INDX1 N2 >OUT3"),
    ("SFND", "STR_FIND", "IN1=0 IN2=1 >OUT2"),
    ("CFND", "CHR_FIND", "IN1=0 IN2=1 >OUT2"),
    ("SHRB", "SHRB", "DATA0 S_BIT1 N2"),
    ("ATT", "AD_T_TBL", "DATA0 TBL1"),
    ("FIFO", "FIFO", "TBL0 >DATA1"),
    ("LIFO", "LIFO", "TBL0 >DATA1"),
    ("FILL", "FILL_N", "IN0 N2 >OUT1"),
    ("FOR", "FOR", "INDX0 INIT1 FINAL2"),
    ("ATCH", "ATCH", "INT0 EVNT1"),
    ("DTCH", "DTCH", "EVNT0"),
    ("CEVNT", "CLR_EVNT", "EVNT0"),
    ("DLED", "DIAG_LED", "IN0"),
    ("HDEF", "HDEF", "HSC0 MODE1"),
    ("HSC", "HSC", "N0"),
    ("PLS", "PLS", "Q0"),
    ("PID", "PID", "TBL0 LOOP1"),
    ("XMT", "XMT", "TBL0 PORT1"),
    ("RCV", "RCV", "TBL0 PORT1"),
    ("NETR", "NETR", "TBL0 PORT1"),
    ("NETW", "NETW", "TBL0 PORT1"),
    ("GPA", "GET_ADDR", "ADDR0 PORT1"),
    ("SPA", "SET_ADDR", "ADDR0 PORT1"),
    ("TODR", "READ_RTC", "T0"),
    ("TODW", "SET_RTC", "T0"),
    ("TODRX", "READ_RTCX", "T0"),
    ("TODWX", "SET_RTCX", "T0"),
    ("BITIM", "BGN_ITIME", ">OUT0"),
    ("CITIM", "CAL_ITIME", "IN0 >OUT1"),
];

/// Families with a letter for the size: `MOVB`, `MOVW`, `MOVD` are MOV_B, MOV_W, MOV_DW.
const SIZED: &[(&str, &str, &str)] = &[
    ("MOV", "MOV", "IN0 >OUT1"),
    ("BM", "BLKMOV", "IN0 N2 >OUT1"),
    ("INC", "INC", "IN0 >OUT0"),
    ("DEC", "DEC", "IN0 >OUT0"),
    ("INV", "INV", "IN0 >OUT0"),
    ("AND", "WAND", "IN1=0 IN2=1 >OUT1"),
    ("OR", "WOR", "IN1=0 IN2=1 >OUT1"),
    ("XOR", "WXOR", "IN1=0 IN2=1 >OUT1"),
    ("SR", "SHR", "IN0 N1 >OUT0"),
    ("SL", "SHL", "IN0 N1 >OUT0"),
    ("RR", "ROR", "IN0 N1 >OUT0"),
    ("RL", "ROL", "IN0 N1 >OUT0"),
];

/// The box of an instruction with that international mnemonic; none: it has the mnemonic as its title.
pub fn face(name: &str) -> Option<Face> {
    let made = |title: String, detail: &str, pins: &'static str| {
        let pins = pins.split(' ').map(pin).collect();
        Some(Face { title, detail: detail.to_string(), pins })
    };
    if let Some((_, title, pins)) = ROWS.iter().find(|(known, ..)| *known == name) {
        return made((*title).to_string(), "", pins);
    }
    if let Some(relation) = name.strip_prefix("FND") {
        return made("TBL_FIND".to_string(), relation, "TBL0 PTN1 INDX2");
    }
    let (head, size) = name.split_at_checked(name.len().checked_sub(1)?)?;
    let arithmetic = match head {
        "+" => Some(("ADD", "IN1=0 IN2=1 >OUT1")),
        "*" => Some(("MUL", "IN1=0 IN2=1 >OUT1")),
        "-" => Some(("SUB", "IN1=1 IN2=0 >OUT1")),
        "/" => Some(("DIV", "IN1=1 IN2=0 >OUT1")),
        _ => None,
    };
    if let Some((title, pins)) = arithmetic {
        let ty = if size == "D" { "DI" } else { size };
        return made(format!("{title}_{ty}"), "", pins);
    }
    let size = match size {
        "B" | "W" | "R" => size,
        "D" => "DW",
        _ => return None,
    };
    let (_, title, pins) = SIZED.iter().find(|(known, ..)| *known == head)?;
    made(format!("{title}_{size}"), "", pins)
}

fn pin(word: &'static str) -> Pin {
    let (name, output) = word.strip_prefix('>').map_or((word, false), |name| (name, true));
    let (name, operand) = name.split_once('=').unwrap_or_else(|| name.split_at(name.len() - 1));
    Pin { name, output, operand: operand.parse().expect("the tables end in numbers") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_the_pins_of_micro_win() {
        let shown = |name: &str| {
            let face = face(name).expect("a box");
            let pins = face
                .pins
                .iter()
                .map(|pin| format!("{}{}={}", if pin.output { ">" } else { "" }, pin.name, pin.operand));
            format!("{}{}: {}", face.title, face.detail, pins.collect::<Vec<_>>().join(" "))
        };
        assert_eq!(shown("MOVD"), "MOV_DW: IN=0 >OUT=1");
        // OUT is the first number of a difference.
        assert_eq!(shown("-I"), "SUB_I: IN1=1 IN2=0 >OUT=1");
        assert_eq!(shown("+D"), "ADD_DI: IN1=0 IN2=1 >OUT=1");
        assert_eq!(shown("SLW"), "SHL_W: IN=0 N=1 >OUT=0");
        assert_eq!(shown("FND<>"), "TBL_FIND<>: TBL=0 PTN=1 INDX=2");
        assert!(face("TON").is_none() && face("ROUND").is_none());
    }
}
