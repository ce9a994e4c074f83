//! Names of boxes in LAD and FBD, and other spellings of instructions.
//!
//! A box is read as its instruction where the order of operands is the same. Source: S7-200 system manual, instruction set.

/// Spellings that mean an instruction, with its mnemonic in the international set.
pub const ALIASES: &[(&str, &str)] = &[
    ("MOV_B", "MOVB"),
    ("MOV_W", "MOVW"),
    ("MOV_DW", "MOVD"),
    ("MOV_R", "MOVR"),
    ("MOV_BIR", "BIR"),
    ("MOV_BIW", "BIW"),
    ("B_I", "BTI"),
    ("I_B", "ITB"),
    ("I_DI", "ITD"),
    ("DI_I", "DTI"),
    ("DI_R", "DTR"),
    ("S_I", "STI"),
    ("S_DI", "STD"),
    ("S_R", "STR"),
    ("AD_T_TBL", "ATT"),
    ("STR_LEN", "SLEN"),
    ("STR_CPY", "SCPY"),
    ("SSTR_CPY", "SSCPY"),
    ("STR_CAT", "SCAT"),
    ("STR_FIND", "SFND"),
    ("CHR_FIND", "CFND"),
    ("BGN_ITIME", "BITIM"),
    ("CAL_ITIME", "CITIM"),
    ("READ_RTC", "TODR"),
    ("SET_RTC", "TODW"),
    ("READ_RTCX", "TODRX"),
    ("SET_RTCX", "TODWX"),
    ("GET_ADDR", "GPA"),
    ("SET_ADDR", "SPA"),
    ("SCR", "LSCR"),
    ("DIAG_LED", "DLED"),
    ("CLR_EVNT", "CEVNT"),
    ("AIN", "ANI"),
    ("OIN", "ONI"),
    ("LDIN", "LDNI"),
];

/// Boxes whose pins have another order than the operands of their instruction: box, statement.
pub const BOXES: &[(&str, &str)] = &[
    ("ADD_I", "+I IN, OUT"),
    ("ADD_DI", "+D IN, OUT"),
    ("ADD_R", "+R IN, OUT"),
    ("SUB_I", "-I IN, OUT"),
    ("SUB_DI", "-D IN, OUT"),
    ("SUB_R", "-R IN, OUT"),
    ("MUL_I", "*I IN, OUT"),
    ("MUL_DI", "*D IN, OUT"),
    ("MUL_R", "*R IN, OUT"),
    ("DIV_I", "/I IN, OUT"),
    ("DIV_DI", "/D IN, OUT"),
    ("DIV_R", "/R IN, OUT"),
    ("INC_B", "INCB OUT"),
    ("INC_W", "INCW OUT"),
    ("INC_DW", "INCD OUT"),
    ("DEC_B", "DECB OUT"),
    ("DEC_W", "DECW OUT"),
    ("DEC_DW", "DECD OUT"),
    ("INV_B", "INVB OUT"),
    ("INV_W", "INVW OUT"),
    ("INV_DW", "INVD OUT"),
    ("WAND_B", "ANDB IN, OUT"),
    ("WAND_W", "ANDW IN, OUT"),
    ("WAND_DW", "ANDD IN, OUT"),
    ("WOR_B", "ORB IN, OUT"),
    ("WOR_W", "ORW IN, OUT"),
    ("WOR_DW", "ORD IN, OUT"),
    ("WXOR_B", "XORB IN, OUT"),
    ("WXOR_W", "XORW IN, OUT"),
    ("WXOR_DW", "XORD IN, OUT"),
    ("SHR_B", "SRB OUT, N"),
    ("SHR_W", "SRW OUT, N"),
    ("SHR_DW", "SRD OUT, N"),
    ("SHL_B", "SLB OUT, N"),
    ("SHL_W", "SLW OUT, N"),
    ("SHL_DW", "SLD OUT, N"),
    ("ROR_B", "RRB OUT, N"),
    ("ROR_W", "RRW OUT, N"),
    ("ROR_DW", "RRD OUT, N"),
    ("ROL_B", "RLB OUT, N"),
    ("ROL_W", "RLW OUT, N"),
    ("ROL_DW", "RLD OUT, N"),
    ("BLKMOV_B", "BMB IN, OUT, N"),
    ("BLKMOV_W", "BMW IN, OUT, N"),
    ("BLKMOV_D", "BMD IN, OUT, N"),
    ("FILL_N", "FILL IN, OUT, N"),
    ("BCD_I", "BCDI OUT"),
    ("I_BCD", "IBCD OUT"),
    ("I_S", "ITS IN, OUT, FMT"),
    ("DI_S", "DTS IN, OUT, FMT"),
    ("R_S", "RTS IN, OUT, FMT"),
    ("TBL_FIND", "FND= TBL, PTN, INDX"),
];

/// The mnemonic for which `word` (upper case) is another spelling.
pub fn mnemonic(word: &str) -> Option<String> {
    if let Some((_, mnemonic)) = ALIASES.iter().find(|(alias, _)| *alias == word) {
        return Some((*mnemonic).to_owned());
    }
    // `LDDW=`, `ADW<>`, `ODW>=`: comparisons of double words in older texts.
    let at = word.find(['=', '<', '>'])?;
    let (name, relation) = word.split_at_checked(at)?;
    matches!(name, "LDDW" | "ADW" | "UDW" | "ODW")
        .then(|| format!("{}{relation}", name.strip_suffix('W').unwrap_or(name)))
}

/// The statement for a box whose operands have another order.
pub fn statement_of_box(word: &str) -> Option<&'static str> {
    BOXES.iter().find(|(name, _)| *name == word).map(|(_, statement)| *statement)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::s7200::Insn;
    use crate::s7200::mnemonics::instruction;
    use crate::stl::Mnemonics;

    #[test]
    fn each_alias_names_an_instruction_and_is_none() {
        for (alias, mnemonic) in ALIASES {
            assert!(instruction(mnemonic, Mnemonics::En).is_some(), "{alias}");
            assert!(!Insn::ROWS.iter().any(|insn| insn.mnemonic(Mnemonics::En) == *alias), "{alias}");
        }
        for (name, statement) in BOXES {
            let word = statement.split(' ').next().unwrap();
            assert!(instruction(word, Mnemonics::En).is_some(), "{name}");
            let operands = instruction(word, Mnemonics::En).unwrap().operands().len();
            assert_eq!(statement.matches(',').count() + 1, operands, "{name}");
        }
    }

    #[test]
    fn double_words_in_comparisons() {
        assert_eq!(mnemonic("LDDW="), Some("LDD=".to_owned()));
        assert_eq!(mnemonic("ODW<>"), Some("OD<>".to_owned()));
        assert_eq!(mnemonic("LDQW="), None);
    }
}
