// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/completion_command.h"

#include <iostream>
#include <memory>
#include <string>

#include "overtone/client/cli/completion.h"
#include "overtone/client/cli/exit_code.h"

namespace overtone {
namespace {

constexpr char kProgram[] = "overtone";

std::string Script(const std::string& shell, const CompletedCommand& root) {
  if (shell == "bash") return BashCompletion(root, kProgram);
  return shell == "zsh" ? ZshCompletion(root, kProgram) : FishCompletion(root, kProgram);
}

}  // namespace

void AddCompletionCommand(CLI::App* app, std::function<int()>* run) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command =
      app->add_subcommand("completion", "Print a script that lets the shell complete commands");
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->required();
  command->footer(
      "  source <(overtone completion bash)\n"
      "  overtone completion bash > ~/.local/share/bash-completion/completions/overtone\n"
      "  overtone completion zsh > ~/.zfunc/_overtone             # with ~/.zfunc in fpath\n"
      "  overtone completion fish > ~/.config/fish/completions/overtone.fish");
  command->callback([app, shell, run] {
    *run = [app, shell]() -> int {
      std::cout << Script(*shell, Describe(*app));
      return kDone;
    };
  });
}

}  // namespace overtone
