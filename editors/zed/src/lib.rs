//! Starts `sidc lsp` for Zed.

use zed_extension_api::settings::LspSettings;
use zed_extension_api::{
    Command, Extension, LanguageServerId, Result, Worktree, register_extension,
};

struct Sid;

impl Extension for Sid {
    fn new() -> Self {
        Sid
    }

    /// The program in the settings (`lsp.sidc.binary.path`), or the one on the path.
    fn language_server_command(
        &mut self,
        id: &LanguageServerId,
        tree: &Worktree,
    ) -> Result<Command> {
        let settings = LspSettings::for_worktree(id.as_ref(), tree).ok();
        let named = settings.and_then(|s| s.binary).and_then(|b| b.path);
        let missing =
            "sidc is not on the path: cargo install --path crates/cli, or set lsp.sidc.binary.path";
        Ok(Command {
            command: named.or_else(|| tree.which("sidc")).ok_or(missing)?,
            args: vec!["lsp".into()],
            env: tree.shell_env(),
        })
    }
}

register_extension!(Sid);
