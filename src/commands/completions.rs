//! `dose completions`: what a shell needs to complete the command.

use clap::Args;
use clap_complete::Shell;

use crate::failure::Failure;
use crate::terminal::print;

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// bash, zsh, fish, elvish or powershell
    shell: Shell,
}

impl CompletionsArgs {
    /// Prints the completions of `command`.
    pub(crate) fn run(&self, command: &mut clap::Command) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, command, "dose", &mut script);
        print(&String::from_utf8_lossy(&script))
    }
}
