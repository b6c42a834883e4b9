//! Names that no variable of the emitted code may have.

/// Keywords of C and C++, functions and macros of `math.h` and of compilers, and names in the emitted code.
#[rustfmt::skip]
pub(super) const RESERVED: &[&str] = &[
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern", "float", "for", "goto",
    "if", "inline", "int", "long", "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch",
    "typedef", "union", "unsigned", "void", "volatile", "while", "asm", "typeof", "bool", "true", "false", "nullptr", "alignas",
    "alignof", "constexpr", "static_assert", "thread_local", "and", "and_eq", "bitand", "bitor", "catch", "class", "compl", "concept",
    "delete", "dynamic_cast", "explicit", "export", "friend", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "operator",
    "or", "or_eq", "private", "protected", "public", "template", "this", "throw", "try", "typeid", "typename", "using", "virtual",
    "wchar_t", "xor", "xor_eq",
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "fabs", "fmin", "fmax", "pow",
    "INFINITY", "NAN", "HUGE", "HUGE_VAL", "HUGE_VALF", "HUGE_VALL", "FP_NAN", "FP_INFINITE", "FP_ZERO", "FP_SUBNORMAL", "FP_NORMAL",
    "FP_ILOGB0", "FP_ILOGBNAN", "FP_FAST_FMA", "MATH_ERRNO", "MATH_ERREXCEPT", "math_errhandling", "MAXFLOAT", "SNAN", "DOMAIN",
    "SING", "OVERFLOW", "UNDERFLOW", "TLOSS", "PLOSS", "X_TLOSS", "M_E", "M_LOG2E", "M_LOG10E", "M_LN2", "M_LN10", "M_PI", "M_PI_2",
    "M_PI_4", "M_1_PI", "M_2_PI", "M_2_SQRTPI", "M_SQRT2", "M_SQRT1_2", "linux", "unix", "i386", "near", "far", "NULL", "signgam",
    "t", "state", "input", "parameter", "history", "constant", "rate", "slope", "output", "mass", "right", "unknown", "settled", "step",
    "i", "sidc_solve", "sidc_solve_1", "sidc_solve_2", "sidc_settled", "sidc_root", "sidc_sign", "sidc_derivatives", "sidc_next", "sidc_jacobian",
    "sidc_jacobian_input", "sidc_outputs", "sidc_guards", "sidc_rates_by_side", "sidc_guard_rates", "sidc_settle", "sidc_advance", "sidc_step",
    "side", "guard", "after", "sidc_states", "sidc_switches", "sidc_jumps", "sidc_jump_count", "sidc_jump_guards", "sidc_jump_sides", "sidc_gaps",
    "sidc_waits", "SIDC_VERDICT", "SIDC_INPUT_DELAYS",
    "SIDC_CONSTANTS",
];

#[cfg(test)]
mod tests {
    use super::RESERVED;
    use sidc_lang::term::FUNCTIONS;

    #[test]
    fn every_function_is_reserved() {
        for f in FUNCTIONS.iter().filter(|f| !f.spelling.c.is_empty()) {
            assert!(RESERVED.contains(&f.spelling.c), "{}", f.spelling.c);
        }
    }
}
