// The command line of one subcommand: declared once, then parsed, validated and explained from the same declaration.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/isa.h"

namespace pac::cli {

using Args = std::span<char* const>;

// One name of a choice and what it stands for.
template <class T>
struct Choice {
  const char* name;
  T value;
};

// Declare positionals and options, each bound to a variable that holds its default; then parse() fills them. The
// bound variables must outlive the object. Every value is checked here and nowhere else; messages name the range.
class Options {
 public:
  // command: "jpeg encode"; summary: one line; example: a command line that works, without prompt.
  Options(std::string command, std::string summary, std::string example);

  // A required operand; `positionals` (declared last) collects one and more.
  void positional(const char* meta, std::string& target, const char* help);
  void positionals(const char* meta, std::vector<std::string>& targets, const char* help);

  // `names`: "--width", or a short and a long one: "-o|--output".
  void flag(const char* names, bool& target, const char* help);
  void text(const char* names, const char* meta, std::string& target, const char* help, bool required = false);
  void integer(const char* names, const char* meta, int& target, int least, int most, const char* help);
  void real(const char* names, const char* meta, double& target, double least, double most, const char* help);
  // Numbers joined by commas, at least one, none twice.
  void reals(const char* names, const char* meta, std::vector<double>& targets, double least, double most,
             const char* help);
  template <class T>
  void choice(const char* names, T& target, std::initializer_list<Choice<T>> choices, const char* help) {
    std::vector<std::string> labels;
    std::vector<T> values;
    for (const Choice<T>& one : choices) {
      labels.emplace_back(one.name);
      values.push_back(one.value);
    }
    add_choice(names, std::move(labels), help, [&target, values](size_t index) { target = values[index]; });
  }

  // Parses. Empty: go on. Otherwise the exit code: 0 after --help, 2 after a message about wrong usage.
  std::optional<int> parse(Args args);

  // The option of that long or only name was on the command line.
  bool given(std::string_view name) const;

  // Prints "pac COMMAND: PROBLEM" and where to read more; returns the exit code 2.
  int usage_error(const std::string& problem) const;

  // What every subcommand takes.
  bool json = false;
  bool quiet = false;
  int threads = 0;  // 0 = all processors
  Isa isa;

 private:
  struct Option {
    std::string short_name, long_name, meta, help;
    bool takes_value = false;
    bool required = false;
    bool is_common = false;  // listed in one line of the help
    bool given = false;
    std::function<std::string(const std::string&)> set;  // the problem, or empty
  };
  struct Positional {
    std::string meta, help;
    std::string* target;
    std::vector<std::string>* targets = nullptr;  // instead of target
  };

  Option& add(const char* names, const char* meta, const char* help);
  void add_choice(const char* names, std::vector<std::string> labels, const char* help,
                  std::function<void(size_t)> set);
  void add_common();
  std::string set_isa(const std::string& name);
  Option* find(std::string_view name);
  std::string nearest_option(std::string_view name) const;
  std::string parse_option(const std::string& argument, Args args, size_t& next);
  std::string check_complete(size_t n_positionals) const;
  std::string usage_line() const;
  void print_help() const;

  std::string command_, summary_, example_;
  std::vector<Option> options_;
  std::vector<Positional> positionals_;
  bool help_ = false;
};

// The candidate that `word` is most likely a slip of the keys from, or empty where none is near.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

}  // namespace pac::cli
