#include "app/cli/command.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "devices/exchange/files.h"

namespace seamwright::cli {

int exit_code(ErrorKind kind) {
    return kind == ErrorKind::usage || kind == ErrorKind::input ? kExitInput : kExitDevice;
}

CommandLine::CommandLine()
    : app_(
          "Seamwright: robot path correction with laser-stripe sensors.\n"
          "Lengths are millimetres, angles degrees. Exit codes: 0 ok, 1 the verdict is not ok, 2 usage or "
          "bad input,\n"
          "3 device or file failure.",
          "seamwright") {
    app_.require_subcommand(1);
    app_.set_version_flag("--version", SEAMWRIGHT_VERSION);
    app_.footer("Example: seamwright demo --dir demo --seed 1");
}

CLI::App* CommandLine::group(const std::string& name, const std::string& help, const std::string& example) {
    CLI::App* word = app_.add_subcommand(name, help);
    word->require_subcommand(1);
    word->footer("Every method takes --json FILE|-.\nExample:\n  " + example);
    return word;
}

CLI::App* CommandLine::add(const std::string& name, const std::string& help, const std::string& example) {
    return add(app_, name, help, example);
}

CLI::App* CommandLine::add(CLI::App& parent, const std::string& name, const std::string& help,
                           const std::string& example) {
    CLI::App* command = parent.add_subcommand(name, help);
    command->footer("Example:\n  " + example);
    command->add_option("--json", json_target_, "Write the answer as JSON to this file, '-' for stdout")
        ->type_name("FILE|-");
    return command;
}

void CommandLine::on(CLI::App* command, std::function<Expected<Answer>()> action) {
    command->callback([this, action = std::move(action)] { action_ = action; });
}

int CommandLine::run(int argc, char** argv) {
    try {
        app_.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app_.exit(e);  // --help, --version
        fmt::print(stderr, "seamwright: {}\nRun with --help for usage.\n", e.what());
        return kExitInput;
    }
    Expected<Answer> answer;
    try {
        answer = action_();
    } catch (const std::exception& e) {  // out of memory and the like: still one sentence, never a bare abort
        fmt::print(stderr, "seamwright: {}\n", e.what());
        return kExitDevice;
    }
    if (!answer) {
        fmt::print(stderr, "seamwright: {}\n", answer.error().sentence());
        return exit_code(answer.error().kind);
    }
    if (json_target_.empty()) {
        std::fwrite(answer->text.data(), 1, answer->text.size(), stdout);
        if (!answer->text.empty() && answer->text.back() != '\n') std::fputc('\n', stdout);
    } else {
        const std::string text =
            answer->json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
        if (json_target_ == "-") {
            std::fwrite(text.data(), 1, text.size(), stdout);
        } else if (auto written = write_text_file(json_target_, text); !written) {
            fmt::print(stderr, "seamwright: {}\n", written.error().sentence());
            return exit_code(written.error().kind);
        }
    }
    if (std::fflush(stdout) != 0) {
        fmt::print(stderr, "seamwright: stdout: could not be written\n");
        return kExitDevice;
    }
    return answer->exit_code;
}

}  // namespace seamwright::cli
