//! Subroutines of the libraries that come with Micro/WIN, and those that its wizards make. Programs call them, and plcc does not have them.
//!
//! Source: S7-200 system manual, USS protocol library, Modbus protocol library, and the chapters of the wizards.

/// A subroutine of a library.
pub struct Subroutine {
    /// The library: `Modbus slave`.
    pub library: &'static str,
    parameters: &'static str,
}

impl Subroutine {
    /// The parameters, and whether they are outputs. EN is not among them.
    pub fn parameters(&self) -> impl Iterator<Item = (&'static str, bool)> {
        let words = self.parameters.split(' ');
        words.map(|word| word.strip_prefix('>').map_or((word, false), |output| (output, true)))
    }
}

const READ: &str = "XMT_REQ Drive Param Index DB_Ptr >Done >Error >Value";
const WRITE: &str = "XMT_REQ EEPROM Drive Param Index Value DB_Ptr >Done >Error";
const MASTER: &str = "Mode Baud Parity Timeout >Done >Error";
const MESSAGE: &str = "First Slave RW Addr Count DataPtr >Done >Error";

/// Names, libraries and parameters; `>`: an output.
const ROWS: &[(&str, &str, &str)] = &[
    ("USS_INIT", "USS", "Mode Baud Active >Done >Error"),
    (
        "USS_CTRL",
        "USS",
        "RUN OFF2 OFF3 F_ACK DIR Drive Type Speed_SP >Resp_R >Error >Status >Speed >Run_EN >D_Dir >Inhibit >Fault",
    ),
    ("USS_RPM_W", "USS", READ),
    ("USS_RPM_D", "USS", READ),
    ("USS_RPM_R", "USS", READ),
    ("USS_WPM_W", "USS", WRITE),
    ("USS_WPM_D", "USS", WRITE),
    ("USS_WPM_R", "USS", WRITE),
    ("MBUS_INIT", "Modbus slave", "Mode Addr Baud Parity Delay MaxIQ MaxAI MaxHold HoldStart >Done >Error"),
    ("MBUS_SLAVE", "Modbus slave", ">Done >Error"),
    ("MBUS_CTRL", "Modbus master", MASTER),
    ("MBUS_CTRL_P1", "Modbus master", MASTER),
    ("MBUS_MSG", "Modbus master", MESSAGE),
    ("MBUS_MSG_P1", "Modbus master", MESSAGE),
];

/// The subroutine of a library that has this name.
pub fn subroutine(name: &str) -> Option<Subroutine> {
    let &(_, library, parameters) = ROWS.iter().find(|(known, ..)| known.eq_ignore_ascii_case(name))?;
    Some(Subroutine { library, parameters })
}

/// Names without the number of the unit, what the wizard is for, and what follows `_` in the names of its subroutines.
const WIZARDS: &[(&str, &str, &str)] = &[
    ("NET", "for NETR and NETW", "EXE"),
    ("PID", "for PID loops", "INIT CTRL"),
    ("PTO", "for pulse outputs", "CTRL RUN MAN LDPOS ADV"),
    ("PWM", "for pulse outputs", "RUN"),
    ("POS", "for position control", "CTRL MAN GOTO RUN RSEEK LDOFF LDPOS SRATE DIS CLR CFG"),
    ("AXIS", "for motion control", "CTRL MAN GOTO RUN RSEEK LDOFF LDPOS SRATE DIS CFG CACHE"),
    ("ETH", "for Ethernet modules", "CTRL CFG XFR"),
    ("MOD", "for modem modules", "CTRL XFR MSG"),
    ("ASI", "for AS-Interface modules", "CTRL"),
    ("RCP", "for recipes", "READ WRITE"),
    ("DAT", "for data logs", "WRITE"),
    ("TD", "for text displays", "CTRL ALM"),
];

/// What the wizard is for that makes a subroutine with this name: `PTO0_CTRL`, `NET_EXE`, `TD_CTRL_0`.
pub fn wizard(name: &str) -> Option<&'static str> {
    let name = name.to_ascii_uppercase();
    let (unit, end) = name.split_once('_')?;
    let unit = unit.trim_end_matches(|c: char| c.is_ascii_digit());
    let end = end.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_');
    let row = WIZARDS.iter().find(|(known, _, ends)| *known == unit && ends.split(' ').any(|known| known == end))?;
    Some(row.1)
}
