//! `sidc man [COMMAND]`: manual pages, for packagers. Not shown by `sidc --help`.

use clap::error::ErrorKind;
use clap_mangen::Man;

use crate::exit_status;
use crate::failure::Failure;
use crate::outputs::stdout;

/// Print the manual page of sidc, or of one of its commands
#[derive(clap::Args)]
pub struct Args {
    command: Option<String>,
}

/// `program` is the whole command line. An unknown command is a usage error.
pub fn run(args: &Args, mut program: clap::Command) -> Result<u8, Failure> {
    program.build();
    let page = match &args.command {
        None => program,
        Some(name) => chosen(&mut program, name),
    };
    // Pages are filed under the full name, such as `sidc-identify`.
    let title = page.get_display_name().unwrap_or("sidc").to_string();
    let mut text = Vec::new();
    Man::new(page)
        .title(title)
        .render(&mut text)
        .map_err(Failure::internal)?;
    stdout::print(text)?;
    Ok(exit_status::PASS)
}

fn chosen(program: &mut clap::Command, name: &str) -> clap::Command {
    let all = program.get_subcommands().filter(|c| !c.is_hide_set());
    let names: Vec<&str> = all.map(clap::Command::get_name).collect();
    if !names.contains(&name) {
        let text = format!("the commands are {}", names.join(", "));
        program.error(ErrorKind::InvalidSubcommand, text).exit();
    }
    program.find_subcommand(name).cloned().unwrap_or_default()
}
