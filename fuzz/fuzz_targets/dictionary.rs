//! Fuzzes [`sidc_fuzz::attack`] as "dictionary".

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sidc_fuzz::attack("dictionary", data));
