#pragma once
// Who works: --user and where the password comes from. A password is never an argument, which every user of the
// computer could read: it is the first line of a file that nobody else may read, the environment's, or typed at the terminal.

#include <string>

#include "app/cli/command.h"
#include "projects/file/project_file.h"
#include "projects/station/station.h"

namespace seamwright::cli {

// Adds --user and --password-file to a command that edits, proves or pushes.
void add_sign_in(CLI::App* command);

// Opens to write, signed in as --user says. A person who is not needed is one too many: Error (usage) where the project has
// no users.
Expected<ProjectFile> open_to_edit(const std::string& path);
// The same with the station; refused at once where the person may not do what the command is for.
Expected<Station> open_station(const std::string& path, std::optional<Deed> deed = std::nullopt);

struct PasswordSource {
    std::string file;         // its first line
    const char* environment;  // name of the variable
    std::string asked;        // what the terminal asks for
    bool twice = false;       // a new one
};
// Error (usage): none of them; (input): a file that others may read, or that is empty.
Expected<std::string> read_password(const PasswordSource& source);

}  // namespace seamwright::cli
