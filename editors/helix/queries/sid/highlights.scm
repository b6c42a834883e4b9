; Highlights the words of a model with the compiler's token types (compared in tests/it/editor).

["sidc" "system" "state" "input" "output" "param" "unknown" "let" "data" "constrain" "coef" "symmetry" "when" "limit" "prefer" "include"] @keyword
["in" "per" "run" "step" "none" "cyclic"] @attribute
(attribute_name) @attribute

(system_name) @namespace
(name) @variable
(column) @variable

((function_name) @function.macro
  (#any-of? @function.macro "poly" "powers" "fourier" "lags"))
((function_name) @function.builtin
  (#any-of? @function.builtin
    "sin" "cos" "tan" "asin" "acos" "atan" "sinh" "cosh" "tanh" "exp" "log" "sqrt" "abs" "sign" "step" "min" "max"
    "known" "required" "coef" "next" "lag" "unwrap"))
((function_name) @function
  (#not-any-of? @function
    "sin" "cos" "tan" "asin" "acos" "atan" "sinh" "cosh" "tanh" "exp" "log" "sqrt" "abs" "sign" "step" "min" "max"
    "known" "required" "coef" "next" "lag" "unwrap" "poly" "powers" "fourier" "lags"))

(number) @constant.numeric
(share) @constant.numeric
(text) @string
(comment) @comment

["~" "=" "<=" ">=" "<" ">" "->" "+" "-" "*" "/" "^" ".." ":"] @operator
["," ";"] @punctuation.delimiter
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
