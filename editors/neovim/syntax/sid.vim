" Highlighting until the server answers, or without a server.
if exists("b:current_syntax")
  finish
endif

syntax keyword sidKeyword sidc system state input output param unknown let data constrain coef symmetry when limit prefer include
syntax keyword sidAttribute order noise memory unit hold linear cubic delay hidden degree plain per run step none in cyclic
syntax match sidFunction /\<\(sin\|cos\|tan\|asin\|acos\|atan\|sinh\|cosh\|tanh\|exp\|log\|sqrt\|abs\|sign\|min\|max\)\>/
syntax match sidGenerator /\<\(poly\|powers\|fourier\|lags\|known\|required\|next\|lag\|unwrap\)\>/
syntax match sidFunction /\(\<let\s\+\)\@<=\K\k*\ze\s*(/
syntax match sidNumber /\<\d\+\(\.\d\+\)\?\([eE][+-]\?\d\+\)\?%\?/
syntax region sidText start=/"/ end=/"/ oneline
syntax match sidComment /#.*$/
syntax match sidRelation /[~=<>]/

highlight default link sidKeyword Keyword
highlight default link sidAttribute Type
highlight default link sidFunction Function
highlight default link sidGenerator Macro
highlight default link sidNumber Number
highlight default link sidText String
highlight default link sidComment Comment
highlight default link sidRelation Operator

let b:current_syntax = "sid"
