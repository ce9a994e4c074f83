//! The structures of the language and the CPU, with their components and start values.
//!
//! Source: LAD/FBD reference for S7-1200, data types, date and time, GET_ERROR, CTRL_HSC_EXT, and T_CONFIG.

use plcc_model::types::{DTL, Elementary};

use Part::{Bytes, Chars, One, Text, Uints};

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
pub enum Part {
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

/// A structure of the table.
pub struct Structure {
    pub name: &'static str,
    pub members: &'static [(&'static str, Part)],
    /// Its start value; all zero if empty.
    pub default: &'static [u8],
}

/// All structures.
#[rustfmt::skip]
pub const STRUCTURES: &[Structure] = &[
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
