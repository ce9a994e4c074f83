//! System functions (SFC).
//!
//! One table: number, name, parameters in the order of declaration, function. A call finds the parameters in memory as a
//! structure by the layout rules of a STRUCT in the order IN, OUT with RET_VAL first, IN_OUT; so the offsets follow from
//! the row. RET_VAL with bit 15 set is an error and sets BR to 0.
//!
//! Source: System and standard functions, parameter tables.

mod alarms;
mod any;
mod array_db;
mod block_move;
mod clock;
mod communication;
mod control;
pub mod data_blocks;
mod dates;
mod delay;
mod disable;
mod distributed;
pub(crate) mod dtl;
mod hardware;
mod hexadecimal;
mod images;
mod load_memory;
mod local_error;
mod masks;
pub(crate) mod meters;
mod modbus;
mod module_records;
mod names;
pub(crate) mod numbers;
mod output_bits;
mod parameters;
mod partners;
mod records;
mod station;
mod status_list;
mod technology;
mod text;
mod time_of_day;
mod variants;
pub(crate) mod zone;

use plcc_abi::codes::sync;

use crate::cpu::Cpu;
use parameters::{Call, Kind, PARAMETERS_MAX};

/// How a system function ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// RET_VAL; an error when negative.
    RetVal(u16),
    /// The function has no RET_VAL of type INT.
    Plain,
    /// As `Plain`, with BR.
    Flag(bool),
}

const OK: Outcome = Outcome::RetVal(0);

fn error(code: u16) -> Outcome {
    Outcome::RetVal(code)
}

type Function = fn(&Call) -> Outcome;

struct Row {
    number: u16,
    name: &'static str,
    parameters: &'static [Kind],
    offsets: [u8; PARAMETERS_MAX],
    /// Index of RET_VAL in `parameters`.
    ret_val: Option<usize>,
    function: Function,
}

macro_rules! system_functions {
    ($( $number:literal $name:ident ( $($in:ident),* ) -> ( $($out:ident),* ) = $function:path ; )*) => {
        static TABLE: &[Row] = &[ $( Row {
            number: $number,
            name: stringify!($name),
            parameters: &[ $(Kind::$in,)* $(Kind::$out),* ],
            offsets: parameters::offsets(&[ $(Kind::$in,)* $(Kind::$out),* ]),
            ret_val: { const OUTS: &[Kind] = &[$(Kind::$out),*]; const INS: &[Kind] = &[$(Kind::$in),*];
                if OUTS.is_empty() { None } else { Some(INS.len()) } },
            function: $function,
        } ),* ];
    };
}

// Sorted by number. The first of the results is RET_VAL.
system_functions! {
    0 SET_CLK  (DateAndTime)             -> (Word)            = clock::set_clk;
    1 READ_CLK ()                        -> (Word, DateAndTime) = clock::read_clk;
    2 SET_RTM  (Byte, Word)              -> (Word)            = meters::set;
    3 CTRL_RTM (Byte, Bool)              -> (Word)            = meters::control;
    4 READ_RTM (Byte)                    -> (Word, Bool, Word) = meters::read;
    5 GADR_LGC (Byte, Word, Word, Byte, Word) -> (Word, Byte, Word) = station::gadr_lgc;
    6 RD_SINFO ()                        -> (Word, StartInfo, StartInfo) = control::rd_sinfo;
    9 EN_MSG (Bool, Byte, Dword)       -> (Word, Bool)      = alarms::en_msg;
    10 DIS_MSG (Bool, Byte, Dword)     -> (Word, Bool)      = alarms::dis_msg;
    13 DPNRM_DG (Bool, Word)              -> (Word, Any, Bool) = distributed::dpnrm_dg;
    14 DPRD_DAT (Word)                    -> (Word, Any)       = distributed::dprd_dat;
    15 DPWR_DAT (Word, Any)               -> (Word)            = distributed::dpwr_dat;
    17 ALARM_SQ (Bool, Word, Dword, Any) -> (Word)          = alarms::alarm_sq;
    18 ALARM_S  (Bool, Word, Dword, Any) -> (Word)          = alarms::alarm_s;
    19 ALARM_SC (Dword)                -> (Word, Bool, NextBool) = alarms::alarm_sc;
    20 BLKMOV   (Any)                     -> (Word, Any)       = block_move::blkmov;
    21 FILL     (Any)                     -> (Word, Any)       = block_move::fill;
    22 CREAT_DB (Word, Word, Word)        -> (Word, Word)      = data_blocks::creat_db;
    23 DEL_DB   (Word)                    -> (Word)            = data_blocks::del_db;
    24 TEST_DB  (Word)                    -> (Word, Word, Bool) = data_blocks::test_db;
    25 COMPRESS ()                        -> (Word, Bool, NextBool) = control::compress;
    26 UPDAT_PI (Byte)                    -> (Word, Word)      = images::update_inputs;
    27 UPDAT_PO (Byte)                    -> (Word, Word)      = images::update_outputs;
    28 SET_TINT (Word, DateAndTime, Word) -> (Word)            = time_of_day::set_tint;
    29 CAN_TINT (Word)                    -> (Word)            = time_of_day::can_tint;
    30 ACT_TINT (Word)                    -> (Word)            = time_of_day::act_tint;
    31 QRY_TINT (Word)                    -> (Word, Word)      = time_of_day::qry_tint;
    32 SRT_DINT (Word, Dword, Word)       -> (Word)            = delay::srt_dint;
    33 CAN_DINT (Word)                    -> (Word)            = delay::can_dint;
    34 QRY_DINT (Word)                    -> (Word, Word)      = delay::qry_dint;
    36 MSK_FLT  (Dword, Dword)            -> (Word, Dword, Dword) = masks::msk_flt;
    37 DMSK_FLT (Dword, Dword)            -> (Word, Dword, Dword) = masks::dmsk_flt;
    38 READ_ERR (Dword, Dword)            -> (Word, Dword, Dword) = masks::read_err;
    39 DIS_IRT  (Byte, Word)              -> (Word)            = disable::dis_irt;
    40 EN_IRT   (Byte, Word)              -> (Word)            = disable::en_irt;
    41 DIS_AIRT ()                        -> (Word)            = disable::dis_airt;
    42 EN_AIRT  ()                        -> (Word)            = disable::en_airt;
    43 RE_TRIGR ()                        -> ()                = control::re_trigr;
    44 REPL_VAL (Dword)                   -> (Word)            = control::repl_val;
    46 STP      ()                        -> ()                = control::stp;
    47 WAIT     (Word)                    -> ()                = control::wait;
    48 SNC_RTCB ()                        -> (Word)            = control::snc_rtcb;
    49 LGC_GADR (Byte, Word)           -> (Word, Byte, Word, Word, Word) = station::lgc_gadr;
    50 RD_LGADR (Byte, Word)           -> (Word, Any, Word, Any, Word) = station::rd_lgadr;
    51 RDSYSST  (Bool, Word, Word)     -> (Word, Bool, Dword, Any) = status_list::rdsysst;
    52 WR_USMSG (Bool, Word, Any, Any)    -> (Word)            = control::wr_usmsg;
    55 WR_PARM  (Bool, Byte, Word, Byte, Any) -> (Word, Bool) = module_records::with_data;
    56 WR_DPARM (Bool, Byte, Word, Byte) -> (Word, Bool)    = module_records::of_number;
    57 PARM_MOD (Bool, Byte, Word)     -> (Word, Bool)      = module_records::parm_mod;
    58 WR_REC   (Bool, Byte, Word, Byte, Any) -> (Word, Bool) = module_records::with_data;
    59 RD_REC   (Bool, Byte, Word, Byte) -> (Word, Bool, Any) = module_records::of_number;
    64 TIME_TCK ()                        -> (Dword)           = clock::time_tck;
    70 GEO_LOG  (Word, Word, Word, Word) -> (Word, Word)     = station::geo_log;
    71 LOG_GEO  (Word)                 -> (Word, Word, Word, Word, Word, Word, Word) = station::log_geo;
    79 SET      (Word)                    -> (Word, Pointer)   = output_bits::set;
    80 RSET     (Word)                    -> (Word, Pointer)   = output_bits::rset;
    81 UBLKMOV  (Any)                     -> (Word, Any)       = block_move::ublkmov;
    82 CREA_DBL (Bool, Word, Word, Word, Byte, Any) -> (Word, Bool, Word) = load_memory::crea_dbl;
    83 READ_DBL (Bool, Any)               -> (Word, Bool, Any) = load_memory::read_dbl;
    84 WRIT_DBL (Bool, Any)               -> (Word, Bool, Any) = load_memory::writ_dbl;
    85 CREA_DB  (Word, Word, Word, Byte)  -> (Word, Word)      = load_memory::crea_db;
    101 RTM     (Byte, Byte, Dword)       -> (Word, Bool, Dword) = meters::handle;
    102 RD_DPARA (Word, Byte)             -> (Word, Any)       = module_records::rd_dpara;
    107 ALARM_DQ (Bool, Word, Dword, Dword, Any) -> (Word)     = alarms::alarm_dq;
    108 ALARM_D (Bool, Word, Dword, Dword, Any) -> (Word)      = alarms::alarm_d;
    126 SYNC_PI (Byte, Word)              -> (Word, Word)      = images::synchronous;
    127 SYNC_PO (Byte, Word)              -> (Word, Word)      = images::synchronous;
    // Instructions of the TIA Portal.
    1150 RD_SYS_T ()                        -> (Word, Dtl)       = dtl::read_clock;
    1151 RD_LOC_T ()                        -> (Word, Dtl)       = dtl::read_clock_local;
    1152 WR_SYS_T (Dtl)                     -> (Word)            = dtl::set_clock;
    1153 T_COMBINE (Word, Dword)            -> (Dtl)             = dtl::combine;
    1154 DTL_TO_DATE (Dtl)                  -> (Word)            = dtl::to_date;
    1155 DTL_TO_TOD (Dtl)                   -> (Dword)           = dtl::to_tod;
    1156 DATE_TO_DTL (Word)                 -> (Dtl)             = dtl::from_date;
    1157 DT_TO_DTL (DateAndTime)            -> (Dtl)             = dtl::from_dt;
    1158 DTL_TO_DT (Dtl)                    -> (DateAndTime)     = dtl::to_dt;
    1159 LDT_TO_DTL (Lword)                 -> (Dtl)             = dtl::from_ldt;
    1160 DTL_TO_LDT (Dtl)                   -> (Lword)           = dtl::to_ldt;
    1161 ADD_DTL_TIME (Dtl, Dword, Bool)    -> (Dtl)             = dtl::add;
    1162 SUB_DTL_DTL (Dtl, Dtl)             -> (Dword)           = dtl::difference;
    1163 CONCAT_DATE_TOD (Word, Dword)      -> (Dtl)             = dtl::combine;
    1164 WR_LOC_T (Dtl, Bool)               -> (Word)            = dtl::set_clock_local;
    1168 ADD_DTL_LTIME (Dtl, Lword, Bool)   -> (Dtl)             = dtl::add_long;
    1169 SUB_DTL_DTL_LTIME (Dtl, Dtl)       -> (Lword)           = dtl::long_difference;
    1320 Serialize (Variant)                -> (Word, Variant, Dword) = variants::serialize;
    1321 Deserialize (Variant)              -> (Word, Variant, Dword) = variants::deserialize;
    1322 VariantGet (Variant)               -> (Variant)             = variants::get;
    1323 VariantPut (Variant, Variant)              -> ()                = variants::put;
    1324 READ_BIG (Variant)                 -> (Word, Variant, Dword) = variants::deserialize;
    1325 READ_LITTLE (Variant)              -> (Word, Variant, Dword) = variants::read_little;
    1326 WRITE_BIG (Variant)                -> (Word, Variant, Dword) = variants::serialize;
    1327 WRITE_LITTLE (Variant)             -> (Word, Variant, Dword) = variants::write_little;
    1328 MOVE_BLK_VARIANT (Variant, Dword, Dword, Dword) -> (Word, Variant) = variants::move_block;
    1329 ATH (Variant, Word)                -> (Word, Variant)       = hexadecimal::from_text;
    1330 HTA (Variant, Word)                -> (Word, Variant)       = hexadecimal::to_text;
    1400 GET_ERROR ()                       -> (ErrorStruct)     = local_error::get_error;
    1401 GET_ERR_ID ()                      -> (Word)            = local_error::get_err_id;
    1402 ATTACH (Word, Dword, Bool)         -> (Word)            = technology::attach;
    1403 DETACH (Word, Dword)               -> (Word)            = technology::detach;
    1404 SET_CINT (Word, Dword, Dword)      -> (Word)            = technology::set_cint;
    1405 QRY_CINT (Word)                    -> (Word, Dword, Dword, Word) = technology::qry_cint;
    1406 RUNTIME ()                         -> (Lword, Lword)    = technology::runtime;
    1700 CREATE_DB (Bool, Word, Word, Dword, Byte, Variant) -> (Word, Bool, Word) = load_memory::create_db;
    1701 DELETE_DB (Bool, Word)           -> (Word, Bool)      = load_memory::delete_db;
    1702 ATTR_DB (Bool, Word)             -> (Word, Dword, Byte) = load_memory::attr_db;
    1703 Gen_UsrMsg (Word, Word, Word)    -> (Word, Variant)   = alarms::gen_user_message;
    1704 ReadFromArrayDB (Word, Dword)   -> (Word, Variant)   = array_db::read;
    1705 WriteToArrayDB (Word, Dword, Variant) -> (Word)      = array_db::write;
    1707 DB_ANY_TO_VARIANT (Word)        -> (VariantData, Word) = array_db::to_variant;
    1708 VARIANT_TO_DB_ANY (Variant)     -> (Word, Word)      = array_db::of_variant;
    1709 TypeOfDB (Word)                 -> (Dword)           = array_db::type_of_db;
    1710 RD_ADDR (Word)                  -> (Word, Dword, Word, Dword, Word) = hardware::rd_addr;
    1711 LOG2GEO (Word)                  -> (Word, Variant)   = hardware::log2geo;
    1712 GEO2LOG (Variant)               -> (Word, Word)      = hardware::geo2log;
    1713 IO2MOD (Variant)                -> (Word, Word)      = hardware::io2mod;
    1714 LED (Word, Word)                -> (Word)            = hardware::led;
    1715 DeviceStates (Word, Word)       -> (Word, Variant)   = hardware::states;
    1716 ModuleStates (Word, Word)       -> (Word, Variant)   = hardware::states;
    1717 GET_DIAG (Word, Word)           -> (Word, Word, Variant, Variant) = hardware::get_diag;
    // Parts of library blocks that the runtime does.
    2000 TEXT_CONCAT (Any, Any)          -> (Any)             = text::concat;
    2001 TEXT_COMPARE (Any, Any, Word)   -> (Bool)            = text::compare;
    2002 TEXT_FIND (Any, Any, Word)      -> (Word)            = text::find;
    2003 TEXT_LENGTH (Any, Word)         -> (Word)            = text::length;
    2004 TEXT_REPLACE (Any, Any, Word, Word, Word) -> (Any)   = text::replace;
    2005 TEXT_LEFT (Any, Word, Word)     -> (Any)             = text::left;
    2006 TEXT_RIGHT (Any, Word, Word)    -> (Any)             = text::right;
    2007 TEXT_MID (Any, Word, Word)      -> (Any)             = text::mid;
    2008 TEXT_DELETE (Any, Word, Word, Word) -> (Any)         = text::delete;
    2009 TEXT_INSERT (Any, Any, Word, Word) -> (Any)          = text::insert;
    2010 TEXT_OF_DINT (Dword, Word)       -> (Any)             = numbers::of_dint;
    2011 TEXT_OF_INTEGER (Lword, Word)    -> (Word, Any)       = numbers::of_integer;
    2012 TEXT_OF_REAL (Dword)             -> (Any)             = numbers::of_real;
    2013 TEXT_OF_LREAL (Lword)            -> (Word, Any)       = numbers::of_lreal;
    2014 FIXED_OF_REAL (Dword)            -> (Any)             = numbers::fixed_of_real;
    2015 FIXED_OF_LREAL (Lword)           -> (Word, Any)       = numbers::fixed_of_lreal;
    2016 FIELD_OF_INTEGER (Lword, Word, Word, Word, Word, Word) -> (Word, Any) = numbers::field_of_integer;
    2017 FIELD_OF_LREAL (Lword, Word, Word, Word, Word, Word) -> (Word, Any) = numbers::field_of_lreal;
    2018 TEXT_OF_UNSIGNED (Lword, Word)  -> (Word, Any)       = numbers::of_integer;
    2019 FIELD_OF_UNSIGNED (Lword, Word, Word, Word, Word, Word) -> (Word, Any) = numbers::field_of_integer;
    2020 DINT_OF_TEXT (Any, Word, Dword, Dword) -> (Dword)    = numbers::to_dint;
    2021 REAL_OF_TEXT (Any)               -> (Dword)           = numbers::to_real;
    2022 SCAN_INTEGER (Any, Word, Word, Word) -> (Word, Lword, Word) = numbers::integer_of;
    2023 SCAN_LREAL (Any, Word, Word)     -> (Word, Lword, Word) = numbers::float_of;
    2024 SCAN_REAL (Any, Word, Word)      -> (Word, Dword, Word) = numbers::real_of;
    2025 SCAN_UNSIGNED (Any, Word, Word, Word) -> (Word, Lword, Word) = numbers::integer_of;
    2026 DINT_AT_START (Any, Word)       -> (Dword)           = numbers::dint_at_start;
    2027 INT_AT_START (Any, Word)        -> (Word)            = numbers::int_at_start;
    2028 INT_OF_TEXT (Any, Word, Dword, Dword) -> (Word)      = numbers::to_int;
    2029 TEXT_OF_INT (Word, Word)        -> (Any)             = numbers::of_int;
    2030 DT_ADD (DateAndTime, Dword, Bool) -> (Word, DateAndTime) = dates::add;
    2031 DT_DIFFERENCE (DateAndTime, DateAndTime) -> (Word, Dword) = dates::difference;
    2032 DT_COMBINE (Word, Dword)         -> (Word, DateAndTime) = dates::combine;
    2033 DT_SPLIT (DateAndTime)           -> (Word, Word, Dword, Word) = dates::split;
    2034 DT_COMPARE (DateAndTime, DateAndTime) -> (Word)       = dates::compare;
    2035 REAL_AT_START (Any)              -> (Dword)           = numbers::real_at_start;
    2090 HSC_CONTROL (Word, Byte, Word, Dword, Dword, Word) -> (Word) = technology::hsc_control;
    2091 PWM_CONTROL (Word, Bool)           -> (Word)            = technology::pwm_control;
    2092 HSC_EXTENDED (Word)                -> (Word, Variant)   = technology::hsc_extended;
    2095 ZONE_SET (Word, Word, Dword, Byte, Dword, Byte) -> (Word) = zone::set;
    2100 LINK_OPEN (Any, Word, Bool)      -> (Word, Word)      = communication::open;
    2101 LINK_STATE (Word)                -> (Word, Word, Word) = communication::state;
    2102 LINK_CLOSE (Word, Bool)          -> (Word)            = communication::close;
    2103 LINK_SEND (Word, Dword, Any)     -> (Word)            = communication::send;
    2104 LINK_SENT (Word)                 -> (Word)            = communication::sent;
    2105 LINK_RECEIVE (Word, Dword, Bool) -> (Word, Dword, Any) = communication::receive;
    2106 ALARM_EDGE (Dword, Byte, Bool, NextBool) -> (Word)   = alarms::alarm_edge;
    2107 ALARM_NUMBER ()                 -> (Dword)           = alarms::alarm_number;
    2108 RECORD_OF_ID (Dword)            -> (Word)            = module_records::of_id;
    2109 LINK_RESET (Word)                -> (Word)            = communication::reset;
    2110 JOB_STATE (Dword)               -> (Word, Dword)     = records::job_state;
    2111 JOB_BYTES (Dword)               -> (Word, Dword, Variant) = records::job_bytes;
    2112 LOG_CREATE (Dword, Word, Word, Variant, Variant, Variant) -> (Word, Dword) = records::log_create;
    2113 LOG_OPEN (Word, Variant)        -> (Word, Dword)     = records::log_open;
    2114 LOG_ACTION (Byte, Dword)        -> (Word, Dword)     = records::log_action;
    2115 LOG_NEW (Dword, Variant, Dword) -> (Word, Dword)     = records::log_new;
    2116 LOG_DELETE (Variant, Bool, Dword) -> (Word, Dword)   = records::log_delete;
    2117 RECIPE_JOB (Bool, Variant)      -> (Word, Dword)     = records::recipes;
    2118 FILE_READ (Variant, Dword, Dword, Variant) -> (Word, Dword) = records::file_read;
    2119 FILE_WRITE (Variant, Dword, Dword, Variant) -> (Word, Dword) = records::file_write;
    2120 FILE_DELETE (Variant)           -> (Word, Dword)     = records::file_delete;
    2121 MB_REQUEST (Byte, Dword, Word, Byte, Word, Any) -> (Word, Word, Any) = modbus::request;
    2122 MB_RESPONSE (Any, Any, Any)     -> (Word, Any)       = modbus::response;
    2123 MB_REPLY (Any, Any, Word, Word) -> (Word, Word, Byte, Any, Any) = modbus::reply;
    2124 IO_READ (Dword, Word, Word)     -> (Word, Word, Any) = hardware::read_io;
    2125 IO_WRITE (Dword, Word, Word)    -> (Word, Word, Any) = hardware::write_io;
    2126 REFERENCE_OF (Variant, Dword, Dword, Dword) -> (DateAndTime) = variants::reference;
    2127 INSTANCE_NAME (Any, Dword, Bool) -> (Any)           = names::instance;
    2130 S7_GET   (Word, Any, Any, Any, Any, Any, Any, Any, Any) -> (Word, Dword) = partners::get;
    2131 S7_PUT   (Word, Any, Any, Any, Any, Any, Any, Any, Any) -> (Word, Dword) = partners::put;
    2132 S7_TAKE  (Dword)                 -> (Word, Any, Any, Any, Any) = partners::take;
    2133 S7_STATE (Dword)                 -> (Word)            = partners::state;
    2134 S7_CANCEL (Dword)                -> (Word)            = partners::cancel;
    2135 S7_USEND (Word, Dword, Any, Any, Any, Any) -> (Word, Dword) = partners::usend;
    2136 S7_URCV  (Bool, Word, Dword, Dword) -> (Word, Dword, Any, Any, Any, Any) = partners::urcv;
    2137 S7_BSEND (Word, Dword, Any, Word) -> (Word, Dword)    = partners::bsend;
    2138 S7_BRCV  (Bool, Word, Dword, Dword) -> (Word, Dword, Word, Any) = partners::brcv;
    2139 LINK_SEND_TO (Word, Dword, Any, Any) -> (Word)       = communication::send_to;
    2140 LINK_RECEIVE_FROM (Word, Dword)  -> (Word, Dword, Any, Any) = communication::receive_from;
    2141 LINK_DIAGNOSIS (Word)           -> (Word, Byte, Bool, Dword, Dword) = communication::diagnosis;
}

/// No row.
const NONE: u8 = u8::MAX;

/// The row of each number up to the last.
static INDEX: [u8; LAST + 1] = {
    let mut index = [NONE; LAST + 1];
    let mut row = 0;
    while row < TABLE.len() {
        assert!(row < NONE as usize);
        index[TABLE[row].number as usize] = row as u8;
        row += 1;
    }
    index
};

/// The last number.
const LAST: usize = TABLE[TABLE.len() - 1].number as usize;

fn row(number: u32) -> Option<&'static Row> {
    let &row = INDEX.get(number as usize)?;
    TABLE.get(usize::from(row))
}

/// Number, standard name and parameters of each system function, which the declarations of the standard library must agree with.
/// Parameters are bytes, in the order IN, OUT with RET_VAL first, IN_OUT; 0 for a BOOL in the byte of the BOOL before it.
pub fn table() -> impl Iterator<Item = (u16, &'static str, Vec<u32>)> {
    let bytes = |row: &Row| row.parameters.iter().map(|kind| kind.bytes()).collect();
    TABLE.iter().map(move |row| (row.number, row.name, bytes(row)))
}

/// True for a system function that exists and may be called without parameters (`UC SFC 43`).
pub fn is_without_parameters(number: u16) -> bool {
    row(u32::from(number)).is_some_and(|row| row.parameters.is_empty())
}

/// Result bits of a call.
const BR: u32 = 1;
const STOPPED: u32 = 2;

impl Cpu {
    /// Calls system function `number` with parameters at `block`; `lbase` is the caller's frame.
    /// Result: bit 0 BR, bit 1 STOP.
    pub(crate) fn system_function(&self, site: u32, number: u32, block: u32, lbase: u32) -> u32 {
        let Some(row) = row(number) else {
            return self.sync_error(site, sync::SFC_MISSING, 0, number) * STOPPED;
        };
        let call = Call { cpu: self, site, block, lbase, offsets: &row.offsets };
        let br = match (row.function)(&call) {
            Outcome::RetVal(value) => {
                if let Some(index) = row.ret_val {
                    call.set_word(index, value);
                }
                value & 0x8000 == 0
            }
            Outcome::Plain => true,
            Outcome::Flag(good) => good,
        };
        (if br { BR } else { 0 }) | (self.stop_result() * STOPPED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_sorted_and_unique() {
        assert!(TABLE.windows(2).all(|pair| pair[0].number < pair[1].number));
    }

    #[test]
    fn offsets_follow_the_layout_rules() {
        let offsets = |number: u32| {
            let row = row(number).unwrap();
            row.offsets[..row.parameters.len()].to_vec()
        };
        assert_eq!(offsets(20), [0, 10, 12]);
        assert_eq!(offsets(28), [0, 2, 10, 12]);
        assert_eq!(offsets(32), [0, 2, 6, 8]);
        assert_eq!(offsets(39), [0, 2, 4]);
        assert_eq!(offsets(24), [0, 2, 4, 6]);
        assert_eq!(offsets(1), [0, 2]);
    }
}
