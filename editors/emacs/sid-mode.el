;;; sid-mode.el --- Models of sidc -*- lexical-binding: t; -*-

;; Version: 0.1.0
;; Package-Requires: ((emacs "28.1") (eglot "1.9"))
;; Keywords: languages

;;; Commentary:

;; A major mode for .sid files.  Eglot starts their server, `sidc lsp':
;;
;;   (load "/path/to/editors/emacs/sid-mode.el")
;;   (add-hook 'sid-mode-hook #'eglot-ensure)
;;
;; C-c C-i identifies the model, C-c C-k checks it; both ask for data files.

;;; Code:

(defgroup sid nil "Models of sidc." :group 'languages)

(defcustom sid-program "sidc" "The program." :type 'string)

(defconst sid-font-lock-keywords
  `((,(concat "^[ \t]*" (regexp-opt '("sidc" "system" "state" "input" "output" "param" "unknown" "let" "data"
                                      "constrain" "coef" "symmetry" "when" "limit" "prefer" "include")
                                    'symbols))
     . font-lock-keyword-face)
    (,(regexp-opt '("order" "noise" "memory" "unit" "hold" "linear" "cubic" "delay" "hidden" "degree" "per" "run" "cyclic") 'symbols)
     . font-lock-type-face)
    (,(regexp-opt '("poly" "powers" "fourier" "lags" "known" "required" "next" "lag" "unwrap" "sin" "cos" "tan" "asin" "acos"
                    "atan" "sinh" "cosh" "tanh" "exp" "log" "sqrt" "abs" "sign" "step" "min" "max")
                  'symbols)
     . font-lock-function-name-face)))

(defvar sid-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?# "<" table)
    (modify-syntax-entry ?\n ">" table)
    (modify-syntax-entry ?\" "\"" table)
    (modify-syntax-entry ?' "_" table)
    (modify-syntax-entry ?_ "_" table)
    table))

(defun sid--run (command files)
  "Run `sidc' with COMMAND on this model and FILES."
  (save-buffer)
  (compile (mapconcat #'shell-quote-argument
                      (append (list sid-program command (buffer-file-name)) files)
                      " ")))

(defun sid-identify (file)
  "Identify this model from the table FILE."
  (interactive "fData: ")
  (sid--run "identify" (list (expand-file-name file))))

(defun sid-check (file)
  "Check this model against the table FILE."
  (interactive "fData: ")
  (sid--run "check" (list (expand-file-name file))))

(defvar sid-mode-map
  (let ((map (make-sparse-keymap)))
    (define-key map (kbd "C-c C-i") #'sid-identify)
    (define-key map (kbd "C-c C-k") #'sid-check)
    map))

;;;###autoload
(define-derived-mode sid-mode prog-mode "sid"
  "Major mode for models of sidc."
  (setq-local comment-start "# ")
  (setq-local comment-end "")
  (setq-local indent-tabs-mode nil)
  (setq-local font-lock-defaults '(sid-font-lock-keywords)))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.sid\\'" . sid-mode))

(defvar eglot-server-programs)
(with-eval-after-load 'eglot
  (add-to-list 'eglot-server-programs '(sid-mode . (lambda (&rest _) (list sid-program "lsp")))))

(provide 'sid-mode)
;;; sid-mode.el ends here
