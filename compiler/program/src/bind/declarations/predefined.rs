//! Data types of the language or the CPU: DTL, ErrorStruct, connection descriptions, numbers of hardware objects and OBs, and the instance
//! types of IEC timers and counters, which are blocks of the standard library.
//!
//! Source: LAD/FBD reference for S7-1200, data types, date and time, GET_ERROR, CTRL_HSC_EXT, and T_CONFIG.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_syntax::ast::{BlockName, BlockPrefix, Bound, SectionKind, TypeKind, TypeRef, Variable};

use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::typed::{StructBuilder, Typed, TypedStruct, Use, elementary_typed};
use crate::bind::globals::{library, names};
use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::types::{ArrayType, DTL, DataType, Elementary};
use plcc_stdlib::BlockClass;
use plcc_syntax::symbols::{SymbolTarget, parse_address};

/// `DTL#1970-01-01-00:00:00`, a Thursday.
const DTL_DEFAULT: [u8; 12] = [0x07, 0xB2, 1, 1, 5, 0, 0, 0, 0, 0, 0, 0];

/// Length 64, connection 1, TCP, device 1.
const TCON_PARAM_DEFAULT: [u8; 64] = {
    let mut bytes = [0; 64];
    bytes[1] = 64;
    bytes[3] = 1;
    bytes[4] = 0x11;
    bytes[6] = 1;
    bytes
};

/// The CPU's own interface, connection 1, TCP.
const TCON_IP_V4_DEFAULT: [u8; 14] = [0, 64, 0, 1, 0x0B, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// The CPU's own interface, connection 1, ISO-on-TCP.
const TCON_IP_RFC_DEFAULT: [u8; 78] = {
    let mut bytes = [0; 78];
    bytes[1] = 64;
    bytes[3] = 1;
    bytes[4] = 0x0C;
    bytes
};

/// The CPU's own interface, connection 1, TCP, no name.
const TCON_QDN_DEFAULT: [u8; 266] = {
    let mut bytes = [0; 266];
    bytes[1] = 64;
    bytes[3] = 1;
    bytes[4] = 0x0B;
    bytes[6] = 254;
    bytes
};

/// A mail server by its IPv4 address, SMTP; no names.
const TMAIL_V4_DEFAULT: [u8; 850] = {
    let mut bytes = [0; 850];
    bytes[4] = 0x20;
    // Lengths of the texts.
    bytes[16] = 254;
    bytes[272] = 254;
    bytes[528] = 64;
    bytes[594] = 254;
    bytes
};

/// The same by its domain name.
const TMAIL_FQDN_DEFAULT: [u8; 1102] = {
    let mut bytes = [0; 1102];
    bytes[4] = 0x22;
    bytes[12] = 254;
    bytes[268] = 254;
    bytes[524] = 254;
    bytes[780] = 64;
    bytes[846] = 254;
    bytes
};

/// Subfield 30 of 18 bytes: addresses.
const IF_CONF_V4_DEFAULT: [u8; 18] = [0, 30, 0, 18, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// Subfield 40 of 246 bytes: a name.
const IF_CONF_NOS_DEFAULT: [u8; 246] = {
    let mut bytes = [0; 246];
    bytes[1] = 40;
    bytes[3] = 246;
    bytes
};

/// Type of a component.
#[derive(Clone, Copy)]
enum Part {
    One(Elementary),
    /// ARRAY[1..n] OF BYTE.
    Bytes(u16),
    /// ARRAY[1..n] OF UINT.
    Uints(u16),
    /// ARRAY[1..n] OF CHAR.
    Chars(u16),
    /// STRING[n].
    Text(u8),
    /// Another structure of the table.
    Structure(&'static str),
    /// ARRAY[1..n] of another structure of the table.
    Structures(&'static str, u16),
}

use Part::{Bytes, Chars, One, Text, Uints};

struct Structure {
    name: &'static str,
    members: &'static [(&'static str, Part)],
    /// All zero if empty.
    default: &'static [u8],
}

#[rustfmt::skip]
const STRUCTURES: &[Structure] = &[
    Structure {
        name: DTL,
        members: &[
            ("YEAR", One(Elementary::Uint)), ("MONTH", One(Elementary::Usint)), ("DAY", One(Elementary::Usint)),
            ("WEEKDAY", One(Elementary::Usint)), ("HOUR", One(Elementary::Usint)), ("MINUTE", One(Elementary::Usint)),
            ("SECOND", One(Elementary::Usint)), ("NANOSECOND", One(Elementary::Udint)),
        ],
        default: &DTL_DEFAULT,
    },
    Structure {
        name: "ErrorStruct",
        members: &[
            ("ERROR_ID", One(Elementary::Word)), ("FLAGS", One(Elementary::Byte)), ("REACTION", One(Elementary::Byte)),
            ("CODE_ADDRESS", Part::Structure("CREF")), ("MODE", One(Elementary::Byte)), ("OPERAND_NUMBER", One(Elementary::Uint)),
            ("POINTER_NUMBER_LOCATION", One(Elementary::Uint)), ("SLOT_NUMBER_SCOPE", One(Elementary::Uint)),
            ("DATA_ADDRESS", Part::Structure("NREF")),
        ],
        default: &[],
    },
    Structure {
        name: "CREF",
        members: &[("BLOCK_TYPE", One(Elementary::Byte)), ("CB_NUMBER", One(Elementary::Uint)), ("OFFSET", One(Elementary::Udint))],
        default: &[],
    },
    Structure {
        name: "NREF",
        members: &[("AREA", One(Elementary::Byte)), ("DB_NUMBER", One(Elementary::Uint)), ("OFFSET", One(Elementary::Udint))],
        default: &[],
    },
    Structure {
        name: "TCON_Param",
        members: &[
            ("block_length", One(Elementary::Uint)), ("id", One(Elementary::Word)), ("connection_type", One(Elementary::Usint)),
            ("active_est", One(Elementary::Bool)), ("local_device_id", One(Elementary::Usint)),
            ("local_tsap_id_len", One(Elementary::Usint)), ("rem_subnet_id_len", One(Elementary::Usint)),
            ("rem_staddr_len", One(Elementary::Usint)), ("rem_tsap_id_len", One(Elementary::Usint)),
            ("next_staddr_len", One(Elementary::Usint)), ("local_tsap_id", Bytes(16)), ("rem_subnet_id", Bytes(6)),
            ("rem_staddr", Bytes(6)), ("rem_tsap_id", Bytes(16)), ("next_staddr", Bytes(6)), ("spare", One(Elementary::Word)),
        ],
        default: &TCON_PARAM_DEFAULT,
    },
    Structure {
        name: "TimeTransformationRule",
        members: &[
            ("Bias", One(Elementary::Int)), ("DaylightBias", One(Elementary::Int)),
            ("DaylightStartMonth", One(Elementary::Usint)), ("DaylightStartWeek", One(Elementary::Usint)),
            ("DaylightStartWeekday", One(Elementary::Usint)), ("DaylightStartHour", One(Elementary::Usint)),
            ("DaylightStartMinute", One(Elementary::Usint)), ("StandardStartMonth", One(Elementary::Usint)),
            ("StandardStartWeek", One(Elementary::Usint)), ("StandardStartWeekday", One(Elementary::Usint)),
            ("StandardStartHour", One(Elementary::Usint)), ("StandardStartMinute", One(Elementary::Usint)),
            ("TimeZoneName", Text(80)),
        ],
        default: &[],
    },
    Structure {
        name: "VARIANT_DATA",
        members: &[
            ("HEAD", One(Elementary::Dword)), ("DB", One(Elementary::Word)), ("POINTER", One(Elementary::Dword)),
            ("ELEMENTS", One(Elementary::Dword)), ("KIND", One(Elementary::Dword)),
        ],
        default: &[],
    },
    Structure { name: "AssocValues", members: &[("Value", Uints(8))], default: &[] },
    Structure {
        name: "REFERENCE",
        members: &[("DB", One(Elementary::Word)), ("BIT", One(Elementary::Int)), ("BYTE", One(Elementary::Dint))],
        default: &[],
    },
    Structure {
        name: "GEOADDR",
        members: &[
            ("HWTYPE", One(Elementary::Uint)), ("AREA", One(Elementary::Uint)), ("IOSYSTEM", One(Elementary::Uint)),
            ("STATION", One(Elementary::Uint)), ("SLOT", One(Elementary::Uint)), ("SUBSLOT", One(Elementary::Uint)),
        ],
        default: &[],
    },
    Structure {
        name: "DIS",
        members: &[
            ("MaintenanceState", One(Elementary::Dword)), ("ComponentStateDetail", One(Elementary::Dword)),
            ("OwnState", One(Elementary::Uint)), ("IOState", One(Elementary::Word)), ("OperatingState", One(Elementary::Uint)),
        ],
        default: &[],
    },
    Structure {
        name: "DNN",
        members: &[
            ("SubordinateState", One(Elementary::Uint)), ("SubordinateIOState", One(Elementary::Word)),
            ("DNNmode", One(Elementary::Word)),
        ],
        default: &[],
    },
    Structure {
        name: "SI_classic",
        members: &[
            ("EV_CLASS", One(Elementary::Byte)), ("EV_NUM", One(Elementary::Byte)), ("PRIORITY", One(Elementary::Byte)),
            ("NUM", One(Elementary::Byte)), ("TYP2_3", One(Elementary::Byte)), ("TYP1", One(Elementary::Byte)),
            ("ZI1", One(Elementary::Word)), ("ZI2_3", One(Elementary::Dword)),
        ],
        default: &[],
    },
    Structure {
        name: "TADDR_Param",
        members: &[("REM_IP_ADDR", Bytes(4)), ("REM_PORT_NR", One(Elementary::Uint)), ("RESERVED", One(Elementary::Word))],
        default: &[],
    },
    Structure {
        name: "TDIAG_Status",
        members: &[
            ("InterfaceId", One(Elementary::Word)), ("ID", One(Elementary::Word)), ("ConnectionType", One(Elementary::Byte)),
            ("ActiveEstablished", One(Elementary::Bool)), ("State", One(Elementary::Byte)), ("Kind", One(Elementary::Byte)),
            ("SentBytes", One(Elementary::Udint)), ("ReceivedBytes", One(Elementary::Udint)),
        ],
        default: &[],
    },
    Structure {
        name: "IM0_Version",
        members: &[
            ("Type", One(Elementary::Char)), ("Functional", One(Elementary::Usint)), ("Bugfix", One(Elementary::Usint)),
            ("Internal", One(Elementary::Usint)),
        ],
        default: &[],
    },
    Structure {
        name: "IM0_Data",
        members: &[
            ("Manufacturer_ID", One(Elementary::Uint)), ("Order_ID", Text(20)), ("Serial_Number", Text(16)),
            ("Hardware_Revision", One(Elementary::Uint)), ("Software_Revision", Part::Structure("IM0_Version")),
            ("Revision_Counter", One(Elementary::Uint)), ("Profile_ID", One(Elementary::Uint)),
            ("Profile_Specific_Type", One(Elementary::Uint)), ("IM_Version", One(Elementary::Word)),
            ("IM_Supported", One(Elementary::Word)),
        ],
        default: &[],
    },
    Structure { name: "MESSAGE_SEQUENCE", members: &[("CTL", One(Elementary::Byte)), ("STR", Chars(5))], default: &[] },
    Structure {
        name: "MESSAGE_START",
        members: &[
            ("STARTCOND", One(Elementary::Uint)), ("IDLETIME", One(Elementary::Uint)), ("STARTCHAR", One(Elementary::Byte)),
            ("SEQ", Part::Structures("MESSAGE_SEQUENCE", 4)),
        ],
        default: &[],
    },
    Structure {
        name: "MESSAGE_END",
        members: &[
            ("ENDCOND", One(Elementary::Uint)), ("MAXLEN", One(Elementary::Uint)), ("N", One(Elementary::Uint)),
            ("LENGTHSIZE", One(Elementary::Uint)), ("LENGTHM", One(Elementary::Uint)), ("RCVTIME", One(Elementary::Uint)),
            ("MSGTIME", One(Elementary::Uint)), ("CHARGAP", One(Elementary::Uint)), ("SEQ", Part::Structure("MESSAGE_SEQUENCE")),
        ],
        default: &[],
    },
    Structure {
        name: "CONDITIONS",
        members: &[("START", Part::Structure("MESSAGE_START")), ("END", Part::Structure("MESSAGE_END"))],
        default: &[],
    },
    Structure {
        name: "Receive_Conditions",
        members: &[("START", Part::Structure("MESSAGE_START")), ("END", Part::Structure("MESSAGE_END"))],
        default: &[],
    },
    Structure {
        name: "USS_BASE",
        members: &[("Port", One(Elementary::Uint)), ("Baud", One(Elementary::Dint)), ("Drives", One(Elementary::Word))],
        default: &[],
    },
    Structure {
        name: "HSC_Count",
        members: &[
            ("CurrentCount", One(Elementary::Dint)), ("CapturedCount", One(Elementary::Dint)), ("SyncActive", One(Elementary::Bool)),
            ("DirChange", One(Elementary::Bool)), ("CmpResult_1", One(Elementary::Bool)), ("CmpResult_2", One(Elementary::Bool)),
            ("OverflowNeg", One(Elementary::Bool)), ("OverflowPos", One(Elementary::Bool)), ("EnHSC", One(Elementary::Bool)),
            ("EnCapture", One(Elementary::Bool)), ("EnSync", One(Elementary::Bool)), ("EnDir", One(Elementary::Bool)),
            ("EnCV", One(Elementary::Bool)), ("EnSV", One(Elementary::Bool)), ("EnReference1", One(Elementary::Bool)),
            ("EnReference2", One(Elementary::Bool)), ("EnUpperLmt", One(Elementary::Bool)), ("EnLowerLmt", One(Elementary::Bool)),
            ("EnOpMode", One(Elementary::Bool)), ("EnLmtBehavior", One(Elementary::Bool)),
            ("EnSyncBehavior", One(Elementary::Bool)), ("NewDirection", One(Elementary::Int)),
            ("NewOpModeBehavior", One(Elementary::Int)), ("NewLimitBehavior", One(Elementary::Int)),
            ("NewSyncBehavior", One(Elementary::Int)), ("NewCurrentCount", One(Elementary::Dint)),
            ("NewStartValue", One(Elementary::Dint)), ("NewReference1", One(Elementary::Dint)),
            ("NewReference2", One(Elementary::Dint)), ("NewUpperLimit", One(Elementary::Dint)),
            ("New_Lower_Limit", One(Elementary::Dint)),
        ],
        default: &[],
    },
    Structure {
        name: "HSC_Period",
        members: &[
            ("ElapsedTime", One(Elementary::Udint)), ("EdgeCount", One(Elementary::Udint)), ("EnHSC", One(Elementary::Bool)),
            ("EnPeriod", One(Elementary::Bool)), ("NewPeriod", One(Elementary::Int)),
        ],
        default: &[],
    },
    Structure {
        name: "HSC_Frequency",
        members: &[
            ("Frequency", One(Elementary::Dint)), ("EnHSC", One(Elementary::Bool)), ("EnPeriod", One(Elementary::Bool)),
            ("NewPeriod", One(Elementary::Int)),
        ],
        default: &[],
    },
    Structure { name: "IP_V4", members: &[("ADDR", Bytes(4))], default: &[] },
    Structure {
        name: "TCON_IP_v4",
        members: &[
            ("InterfaceId", One(Elementary::Word)), ("ID", One(Elementary::Word)), ("ConnectionType", One(Elementary::Byte)),
            ("ActiveEstablished", One(Elementary::Bool)), ("RemoteAddress", Part::Structure("IP_V4")),
            ("RemotePort", One(Elementary::Uint)), ("LocalPort", One(Elementary::Uint)),
        ],
        default: &TCON_IP_V4_DEFAULT,
    },
    Structure { name: "TSelector", members: &[("TSelLength", One(Elementary::Uint)), ("TSel", Bytes(32))], default: &[] },
    Structure {
        name: "TCON_IP_RFC",
        members: &[
            ("InterfaceId", One(Elementary::Word)), ("ID", One(Elementary::Word)), ("ConnectionType", One(Elementary::Byte)),
            ("ActiveEstablished", One(Elementary::Bool)), ("RemoteAddress", Part::Structure("IP_V4")),
            ("RemoteTSelector", Part::Structure("TSelector")), ("LocalTSelector", Part::Structure("TSelector")),
        ],
        default: &TCON_IP_RFC_DEFAULT,
    },
    Structure {
        name: "TCON_QDN",
        members: &[
            ("InterfaceId", One(Elementary::Word)), ("ID", One(Elementary::Word)), ("ConnectionType", One(Elementary::Byte)),
            ("ActiveEstablished", One(Elementary::Bool)), ("RemoteQDN", Text(254)),
            ("RemotePort", One(Elementary::Uint)), ("LocalPort", One(Elementary::Uint)),
        ],
        default: &TCON_QDN_DEFAULT,
    },
    Structure {
        name: "TCON_IP_v4_SEC",
        members: &[
            ("ConnPara", Part::Structure("TCON_IP_v4")), ("ActivateSecureConn", One(Elementary::Bool)),
            ("TLSServerReqClientCert", One(Elementary::Bool)), ("ExtTLSCapabilities", One(Elementary::Word)),
            ("TLSServerCertRef", One(Elementary::Udint)), ("TLSClientCertRef", One(Elementary::Udint)),
        ],
        default: &[],
    },
    Structure {
        name: "TCON_QDN_SEC",
        members: &[
            ("ConnPara", Part::Structure("TCON_QDN")), ("ActivateSecureConn", One(Elementary::Bool)),
            ("TLSServerReqClientCert", One(Elementary::Bool)), ("ExtTLSCapabilities", One(Elementary::Word)),
            ("TLSServerCertRef", One(Elementary::Udint)), ("TLSClientCertRef", One(Elementary::Udint)),
        ],
        default: &[],
    },
    Structure {
        name: "IF_CONF_Header",
        members: &[("FieldType", One(Elementary::Uint)), ("FieldId", One(Elementary::Uint)), ("SubfieldCount", One(Elementary::Uint))],
        default: &[],
    },
    Structure {
        name: "IF_CONF_V4",
        members: &[
            ("Id", One(Elementary::Uint)), ("Length", One(Elementary::Uint)), ("Mode", One(Elementary::Uint)),
            ("InterfaceAddress", Part::Structure("IP_V4")), ("SubnetMask", Part::Structure("IP_V4")),
            ("DefaultRouter", Part::Structure("IP_V4")),
        ],
        default: &IF_CONF_V4_DEFAULT,
    },
    Structure {
        name: "IF_CONF_NOS",
        members: &[
            ("Id", One(Elementary::Uint)), ("Length", One(Elementary::Uint)), ("Mode", One(Elementary::Uint)), ("NOS", Bytes(240)),
        ],
        default: &IF_CONF_NOS_DEFAULT,
    },
    Structure { name: "EMAIL_ADDR", members: &[("LocalPartPlusAtSign", Text(64)), ("FullQualifiedDomainName", Text(254))], default: &[] },
    Structure {
        name: "TMail_V4",
        members: &[
            ("InterfaceId", One(Elementary::Word)), ("ID", One(Elementary::Word)), ("ConnectionType", One(Elementary::Byte)),
            ("ActiveEstablished", One(Elementary::Bool)), ("CertIndex", One(Elementary::Byte)), ("WatchDogTime", One(Elementary::Time)),
            ("MailServerAddress", Part::Structure("IP_V4")), ("UserName", Text(254)), ("PassWord", Text(254)),
            ("From", Part::Structure("EMAIL_ADDR")),
        ],
        default: &TMAIL_V4_DEFAULT,
    },
    Structure {
        name: "TMail_FQDN",
        members: &[
            ("InterfaceId", One(Elementary::Word)), ("ID", One(Elementary::Word)), ("ConnectionType", One(Elementary::Byte)),
            ("ActiveEstablished", One(Elementary::Bool)), ("CertIndex", One(Elementary::Byte)), ("WatchDogTime", One(Elementary::Time)),
            ("MailServerAddress", Text(254)), ("UserName", Text(254)), ("PassWord", Text(254)), ("From", Part::Structure("EMAIL_ADDR")),
        ],
        default: &TMAIL_FQDN_DEFAULT,
    },
];

/// Names of the CPU's objects, with the type of each.
#[rustfmt::skip]
const NUMBERS: &[(Elementary, &[&str])] = &[
    (Elementary::Word, &[
        "HW_ANY", "HW_IO", "HW_DEVICE", "HW_INTERFACE", "HW_SUBMODULE", "HW_MODULE", "HW_HSC", "HW_PWM", "HW_PTO",
        "HW_DPMASTER", "HW_DPSLAVE", "HW_IOSYSTEM", "HW_IEPORT", "CONN_ANY", "CONN_OUC", "CONN_PRG",
    ]),
    (Elementary::Uint, &["DB_ANY", "DB_DYN", "DB_WWW", "PORT", "RTM", "PIP"]),
    (Elementary::Int, &[
        "OB_ANY", "OB_ATT", "OB_CYCLIC", "OB_DELAY", "OB_TOD", "OB_PCYCLE", "OB_HWINT", "OB_DIAG", "OB_TIMEERROR",
        "OB_STARTUP",
    ]),
    (Elementary::Dword, &["EVENT_ANY", "EVENT_ATT", "EVENT_HWINT", "AOM_IDENT", "CONN_R_ID"]),
];

/// The block of all axes, whose data types have several names.
pub(super) const AXIS: &str = "TO_PositioningAxis";

/// Data types of timers, counters and axes: the blocks whose instances they are; the first available one counts.
///
/// The four timers have one layout, and that of TONR names all components; CTUD does so for the counters.
#[rustfmt::skip]
const INSTANCES: &[(&str, &[&str])] = &[
    ("IEC_TIMER",      &["IEC_TIMER", "TONR", "TON"]),
    ("TP_TIME",        &["TP_TIME", "TP"]),
    ("TON_TIME",       &["TON_TIME", "TON"]),
    ("TOF_TIME",       &["TOF_TIME", "TOF"]),
    ("TONR_TIME",      &["TONR_TIME", "TONR"]),
    ("IEC_LTIMER",     &["IEC_LTIMER", "TONR_LTIME"]),
    ("IEC_COUNTER",    &["IEC_COUNTER", "CTUD_INT", "CTUD"]),
    ("IEC_SCOUNTER",   &["IEC_SCOUNTER", "CTUD_SINT"]),
    ("IEC_USCOUNTER",  &["IEC_USCOUNTER", "CTUD_USINT"]),
    ("IEC_UCOUNTER",   &["IEC_UCOUNTER", "CTUD_UINT"]),
    ("IEC_DCOUNTER",   &["IEC_DCOUNTER", "CTUD_DINT"]),
    ("IEC_UDCOUNTER",  &["IEC_UDCOUNTER", "CTUD_UDINT"]),
    ("IEC_LCOUNTER",   &["IEC_LCOUNTER", "CTUD_LINT"]),
    ("IEC_ULCOUNTER",  &["IEC_ULCOUNTER", "CTUD_ULINT"]),
    ("TO_CommandTable_PTO", &["TO_CommandTable"]),
    ("TO_Axis",        &[AXIS]),
    ("TO_SpeedAxis",   &[AXIS]),
    ("TO_SynchronousAxis", &[AXIS]),
    ("CTU",            &["CTU_INT", "CTU"]),
    ("CTD",            &["CTD_INT", "CTD"]),
    ("CTUD",           &["CTUD_INT", "CTUD"]),
    ("CTU_INT",        &["CTU_INT", "CTU"]),
    ("CTD_INT",        &["CTD_INT", "CTD"]),
    ("CTUD_INT",       &["CTUD_INT", "CTUD"]),
];

/// The members of a data type of the CPU, or of an instance of a block of the library, as a source would declare them; `None`: there is
/// none with this name.
pub fn system_members(name: &str) -> Option<Vec<Variable>> {
    let name = name.trim();
    if let Some(structure) = STRUCTURES.iter().find(|structure| structure.name.eq_ignore_ascii_case(name)) {
        return Some(structure.members.iter().map(|(name, part)| declared(name, *part)).collect());
    }
    let own = [name];
    let candidates = INSTANCES.iter().find(|(ty, _)| ty.eq_ignore_ascii_case(name)).map_or(&own[..], |row| row.1);
    let is_type = |block: &&plcc_stdlib::SystemBlock| matches!(block.class, BlockClass::Fb | BlockClass::Sfb);
    let tia = || candidates.iter().find_map(|name| plcc_stdlib::find_tia(name).filter(is_type));
    let classic = || candidates.iter().find_map(|name| plcc_stdlib::find_name(name).filter(is_type));
    let block = tia().or_else(classic)?;
    let sections = library::parsed(block.language, block.source).sections.into_iter();
    let kept = sections.filter(|section| section.kind != SectionKind::Temp);
    Some(kept.flat_map(|section| section.variables).collect())
}

/// The declaration of a component.
fn declared(name: &str, part: Part) -> Variable {
    let span = Span::default();
    let named = |name: &str| TypeRef { kind: TypeKind::Named(name.to_string()), span };
    let array = |element: TypeRef, count: u16| {
        let bounds = vec![(Bound::Number(1, span), Bound::Number(i64::from(count), span))];
        TypeRef { kind: TypeKind::Array { bounds, element: Box::new(element) }, span }
    };
    let ty = match part {
        One(ty) => named(ty.name()),
        Bytes(count) => array(named(Elementary::Byte.name()), count),
        Uints(count) => array(named(Elementary::Uint.name()), count),
        Chars(count) => array(named(Elementary::Char.name()), count),
        Text(length) => TypeRef { kind: TypeKind::String(Some(Bound::Number(i64::from(length), span))), span },
        Part::Structure(name) => named(name),
        Part::Structures(name, count) => array(named(name), count),
    };
    Variable {
        name: name.to_string(),
        name_span: span,
        attributes: Vec::new(),
        at: None,
        ty,
        initial: None,
        comment: None,
    }
}

impl Declarations<'_> {
    /// The block that a data type's name means: one of the sources, `FB10`, or one of the library; no message.
    pub fn type_block(&self, name: &str) -> Option<(BlockPrefix, u16)> {
        if let Some(number) = self.globals.names.types.get(&plcc_binding::fold(name)) {
            return Some((BlockPrefix::Udt, *number));
        }
        if self.globals.names.symbols.contains_key(&plcc_binding::fold(name)) {
            return match self.globals.global(name) {
                Some(SymbolTarget::Block { prefix, number }) => Some((prefix, u16::try_from(number).ok()?)),
                Some(SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. }) | None => None,
            };
        }
        if let Some(SymbolTarget::Block { prefix, number }) = parse_address(name) {
            return Some((prefix, u16::try_from(number).ok()?));
        }
        let trimmed = name.trim();
        let own = [trimmed];
        let candidates =
            INSTANCES.iter().find(|(ty, _)| ty.eq_ignore_ascii_case(trimmed)).map_or(&own[..], |row| row.1);
        // A function is not a type: where a type is expected, `RTM` is a hardware identifier.
        let is_type = |block: &&plcc_stdlib::SystemBlock| matches!(block.class, BlockClass::Fb | BlockClass::Sfb);
        let tia = || candidates.iter().find_map(|name| plcc_stdlib::find_tia(name).filter(is_type));
        let classic = || candidates.iter().find_map(|name| plcc_stdlib::find_name(name).filter(is_type));
        let block = if self.types.scope.tia { tia().or_else(classic) } else { classic().or_else(tia) }?;
        let key = self.globals.library.key_of(block);
        Some((names::kind_prefix(key.kind), key.number))
    }

    /// Whether the block declares `name` with the common data type of several instructions, so that a call of the variable alone
    /// does not say which of them it means. It is reported then. `write`: a call with the instruction.
    pub fn has_common_data(
        &mut self,
        ctx: &CurrentBlock,
        name: &str,
        span: Span,
        write: impl Fn(&str) -> String,
    ) -> bool {
        let Some(source) = self.globals.sources.code.get(&ctx.key) else { return false };
        let mut variables = source.block().sections.iter().flat_map(|section| &section.variables);
        let Some(TypeKind::Named(ty)) = variables.find(|own| fold(&own.name) == fold(name)).map(|own| &own.ty.kind)
        else {
            return false;
        };
        let (instruction, own, all) = match ty.as_str() {
            "IEC_TIMER" => ("TON", "TON_TIME", "TON, TOF, TP and TONR"),
            "IEC_LTIMER" => ("TON", "TON_LTIME", "TON, TOF, TP and TONR"),
            "IEC_COUNTER" => ("CTU", "CTU_INT", "CTU, CTD and CTUD"),
            _ => return false,
        };
        let names = &self.globals.names;
        if names.types.contains_key(&fold(ty)) || names.symbols.contains_key(&fold(ty)) {
            return false;
        }
        let (ty, text) = (ty.clone(), self.globals.text(span));
        let write = write(instruction);
        self.report(
            Diagnostic::new(Code::NoBlockFits, span, format!("`{text}` is of type {ty}, which is not an instruction"))
                .label(format!("{all} have this data"))
                .help(format!("write `{write}`, or declare the variable with a type such as {own}")),
        );
        true
    }

    /// A type of the language or the CPU that is not a block.
    pub fn predefined(&mut self, name: &str, span: Span) -> Option<Typed> {
        let name = name.trim();
        let numbers = NUMBERS.iter().find(|(_, names)| names.iter().any(|own| own.eq_ignore_ascii_case(name)));
        if let Some((ty, _)) = numbers {
            return Some(elementary_typed(*ty));
        }
        if let Some(kind) = crate::bind::trees::chart_data::type_named(name) {
            return self.resolve_type(&TypeRef { kind, span }, Use::Component);
        }
        let structure = STRUCTURES.iter().find(|structure| structure.name.eq_ignore_ascii_case(name))?;
        let typed = match self.types.predefined.get(structure.name) {
            Some(typed) => typed.clone(),
            None => {
                let typed = self.predefined_structure(structure, span)?;
                self.types.predefined.insert(structure.name, typed.clone());
                typed
            }
        };
        Some(Typed { ty: DataType::Struct(typed.ty), image: typed.image })
    }

    fn predefined_structure(&mut self, structure: &Structure, span: Span) -> Option<TypedStruct> {
        let mut builder = StructBuilder::default();
        for (name, part) in structure.members {
            let typed = match part {
                One(ty) => elementary_typed(*ty),
                Bytes(count) => array_typed(Elementary::Byte, *count, 1),
                Uints(count) => array_typed(Elementary::Uint, *count, 2),
                Text(length) => text_typed(*length),
                Chars(count) => array_typed(Elementary::Char, *count, 1),
                Part::Structure(other) => self.predefined(other, span)?,
                Part::Structures(other, count) => array_of(self.predefined(other, span)?, *count),
            };
            builder.add((*name).to_string(), &typed);
        }
        let mut typed = self.finish_structure(builder, structure.name.to_string(), None, span)?;
        if !structure.default.is_empty() {
            typed.image = structure.default.into();
        }
        Some(typed)
    }
}

/// STRING[length], empty.
fn text_typed(length: u8) -> Typed {
    let mut image = vec![0; usize::from(length) + 2];
    image[0] = length;
    Typed { ty: DataType::String(length), image: image.into() }
}

/// ARRAY[1..count] OF a type of so many bytes.
fn array_typed(element: Elementary, count: u16, bytes: u16) -> Typed {
    let bytes = usize::from(count * bytes).next_multiple_of(2);
    let bounds = vec![(1, i32::from(count))];
    let array = ArrayType { bounds, element: DataType::Elementary(element), bytes: bytes as u32 };
    Typed { ty: DataType::Array(Rc::new(array)), image: vec![0; bytes].into() }
}

/// ARRAY[1..count] of a structure.
fn array_of(element: Typed, count: u16) -> Typed {
    let bounds = vec![(1, i32::from(count))];
    let image = element.image.repeat(usize::from(count));
    let array = ArrayType { bounds, element: element.ty, bytes: image.len() as u32 };
    Typed { ty: DataType::Array(Rc::new(array)), image: image.into() }
}

/// True of blocks that can be components of data blocks and PLC data types: those of the system.
pub fn is_component(kind: BlockKind) -> bool {
    kind == BlockKind::Sfb
}

/// True of the name of an axis.
pub fn is_axis(ty: &TypeKind) -> bool {
    let name = match ty {
        TypeKind::Named(name) | TypeKind::Block(BlockName::Symbol { name, .. }) => name,
        TypeKind::String(_)
        | TypeKind::WideString(_)
        | TypeKind::Array { .. }
        | TypeKind::OpenArray { .. }
        | TypeKind::Reference(_)
        | TypeKind::Struct(_)
        | TypeKind::Block(BlockName::Numbered { .. })
        | TypeKind::Error => return false,
    };
    let is = |own: &str| own.eq_ignore_ascii_case(name.trim());
    is(AXIS) || INSTANCES.iter().any(|(own, blocks)| *blocks == [AXIS] && is(own))
}
