// SPDX-License-Identifier: Apache-2.0
#include <functional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "overtone/client/cli/completion.h"

namespace overtone {
namespace {

void ForEach(const CompletedCommand& command,
             const std::function<void(const CompletedCommand&)>& act) {
  act(command);
  for (const CompletedCommand& child : command.commands) ForEach(child, act);
}

std::string PathText(const CompletedCommand& command) { return absl::StrJoin(command.path, " "); }

bool TakesFiles(const CompletedCommand& command) {
  for (const CompletedOption& option : command.options) {
    if (option.names.empty() && option.takes_file) return true;
  }
  return false;
}

// Flags, and what commands are below.
std::vector<std::string> Words(const CompletedCommand& command) {
  std::vector<std::string> words;
  for (const CompletedCommand& child : command.commands) words.push_back(child.path.back());
  for (const CompletedOption& option : command.options) {
    words.insert(words.end(), option.names.begin(), option.names.end());
    if (option.names.empty()) {
      words.insert(words.end(), option.choices.begin(), option.choices.end());
    }
  }
  return words;
}

std::string Quoted(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", "'\\''"}}), "'");
}

// In a specification of _arguments, brackets and colons separate.
std::string ZshText(const std::string& text) {
  return absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"[", "\\["}, {"]", "\\]"}, {":", "\\:"}});
}

std::string ZshValue(const CompletedOption& option) {
  if (!option.choices.empty()) return absl::StrCat("(", absl::StrJoin(option.choices, " "), ")");
  return option.takes_file ? "_files" : "";
}

std::string ZshArguments(const CompletedCommand& command) {
  std::string text;
  for (const CompletedOption& option : command.options) {
    if (option.names.empty()) {
      absl::StrAppend(&text, " \\\n      ", Quoted(absl::StrCat("*:argument:", ZshValue(option))));
    }
    for (const std::string& name : option.names) {
      absl::StrAppend(&text, " \\\n      ",
                      Quoted(absl::StrCat("*", name, option.takes_value ? "=" : "", "[",
                                          ZshText(option.description), "]",
                                          option.takes_value ? ":value:" + ZshValue(option) : "")));
    }
  }
  return text;
}

std::string ZshCommands(const CompletedCommand& command) {
  std::string text;
  for (const CompletedCommand& child : command.commands) {
    absl::StrAppend(&text, " ",
                    Quoted(absl::StrCat(child.path.back(), ":", ZshText(child.description))));
  }
  return text;
}

// True on the command line of exactly this command.
std::string FishCondition(const CompletedCommand& command) {
  std::string condition;
  for (const std::string& word : command.path) {
    absl::StrAppend(&condition, condition.empty() ? "" : "; and ", "__fish_seen_subcommand_from ",
                    word);
  }
  std::vector<std::string> below;
  for (const CompletedCommand& child : command.commands) below.push_back(child.path.back());
  if (below.empty()) return condition;
  return absl::StrCat(condition, condition.empty() ? "" : "; and ",
                      "not __fish_seen_subcommand_from ", absl::StrJoin(below, " "));
}

}  // namespace

std::string BashCompletion(const CompletedCommand& root, const std::string& program) {
  std::string paths, values, words;
  ForEach(root, [&](const CompletedCommand& command) {
    const std::string path = PathText(command);
    if (!path.empty()) absl::StrAppend(&paths, paths.empty() ? "" : "|", "\"", path, "\"");
    for (const CompletedOption& option : command.options) {
      if (!option.takes_value) continue;
      for (const std::string& name : option.names) {
        absl::StrAppend(&values, "    \"", path, ":", name, "\") ");
        if (!option.choices.empty()) {
          absl::StrAppend(&values, "COMPREPLY=($(compgen -W \"", absl::StrJoin(option.choices, " "),
                          "\" -- \"$cur\")); ");
        } else if (option.takes_file) {
          absl::StrAppend(&values, "mapfile -t COMPREPLY < <(compgen -f -- \"$cur\"); ");
        }
        absl::StrAppend(&values, "return ;;\n");
      }
    }
    absl::StrAppend(&words, "    \"", path, "\") words=\"", absl::StrJoin(Words(command), " "),
                    "\"", TakesFiles(command) ? "; files=yes" : "", " ;;\n");
  });
  return absl::StrReplaceAll(
      R"(# bash completion of PROGRAM, as of `PROGRAM completion bash`.
_PROGRAM() {
  local cur="${COMP_WORDS[COMP_CWORD]}" prev="${COMP_WORDS[COMP_CWORD - 1]}"
  local command="" words="" files="" i
  # bash takes "--flag=value" for three words.
  if [[ $cur == "=" ]]; then
    cur=""
  elif [[ $prev == "=" && $COMP_CWORD -ge 2 ]]; then
    prev="${COMP_WORDS[COMP_CWORD - 2]}"
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${command:+$command }${COMP_WORDS[i]}" in
      PATHS) command="${command:+$command }${COMP_WORDS[i]}" ;;
    esac
  done
  COMPREPLY=()
  case "$command:$prev" in
VALUES  esac
  case "$command" in
WORDS  esac
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
  if [[ -n $files && $cur != -* ]]; then
    mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$cur")
  fi
}
complete -o filenames -F _PROGRAM PROGRAM
)",
      {{"PROGRAM", program}, {"PATHS", paths}, {"VALUES", values}, {"WORDS  ", words + "  "}});
}

std::string ZshCompletion(const CompletedCommand& root, const std::string& program) {
  std::string paths, cases;
  ForEach(root, [&](const CompletedCommand& command) {
    const std::string path = PathText(command);
    if (!path.empty()) absl::StrAppend(&paths, paths.empty() ? "" : "|", Quoted(path));
    absl::StrAppend(&cases, "    ", Quoted(path), ")\n");
    if (!command.commands.empty()) {
      absl::StrAppend(&cases, "      commands=(", ZshCommands(command),
                      " )\n      _describe -t commands command commands\n");
    }
    absl::StrAppend(&cases, "      _arguments", ZshArguments(command), "\n      ;;\n");
  });
  return absl::StrReplaceAll(R"(#compdef PROGRAM
# zsh completion of PROGRAM, as of `PROGRAM completion zsh`.
_PROGRAM() {
  local command="" word
  local -a commands
  local -i depth=0
  for word in ${words[2,CURRENT-1]}; do
    case "${command:+$command }$word" in
      PATHS) command="${command:+$command }$word"; depth+=1 ;;
    esac
  done
  # What follows the command is completed as if it stood alone.
  words=(PROGRAM ${words[2 + depth,-1]})
  CURRENT=$((CURRENT - depth))
  case "$command" in
CASES  esac
}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then
  _PROGRAM "$@"
else
  compdef _PROGRAM PROGRAM
fi
)",
                             {{"PROGRAM", program}, {"PATHS", paths}, {"CASES  ", cases + "  "}});
}

std::string FishCompletion(const CompletedCommand& root, const std::string& program) {
  std::string script = absl::StrCat("# fish completion of ", program, ", as of `", program,
                                    " completion fish`.\ncomplete -c ", program, " -f\n");
  ForEach(root, [&](const CompletedCommand& command) {
    const std::string line =
        absl::StrCat("complete -c ", program, " -n ", Quoted(FishCondition(command)));
    for (const CompletedCommand& child : command.commands) {
      absl::StrAppend(&script, line, " -a ", child.path.back(), " -d ", Quoted(child.description),
                      "\n");
    }
    for (const CompletedOption& option : command.options) {
      absl::StrAppend(&script, line);
      for (const std::string& name : option.names) {
        const bool is_long = name.size() > 2;
        absl::StrAppend(&script, is_long ? " -l " : " -s ", name.substr(is_long ? 2 : 1));
      }
      if (!option.names.empty() && option.takes_value) {
        absl::StrAppend(&script, option.takes_file ? " -r" : " -x");
      }
      if (option.takes_file) absl::StrAppend(&script, " -F");
      if (!option.choices.empty()) {
        absl::StrAppend(&script, " -a ", Quoted(absl::StrJoin(option.choices, " ")));
      }
      absl::StrAppend(&script, " -d ", Quoted(option.description), "\n");
    }
  });
  return script;
}

}  // namespace overtone
