//! Fuzzes [`sidc_fuzz::attack`] as "language".

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sidc_fuzz::attack("language", data));
