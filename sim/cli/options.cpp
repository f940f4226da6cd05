#include "sim/cli/options.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "base/parallel.h"

namespace pac::cli {
namespace {

// Insertions, deletions, substitutions and swaps of neighbors (optimal string alignment).
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> before(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
  std::iota(previous.begin(), previous.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substitution = previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        current[j] = std::min(current[j], before[j - 2] + 1);
    }
    before.swap(previous);
    previous.swap(current);
  }
  return previous[b.size()];
}

template <class T>
bool parse_number(const std::string& text, T& number) {
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

std::string number_text(double number) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", number);
  return digits;
}

std::string range_text(double least, double most) {
  return number_text(least) + ".." + number_text(most);
}

}  // namespace

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    // A word cut short is nearer than its missing letters make it.
    const bool is_prefix = word.size() >= 3 && candidate.starts_with(word);
    const size_t distance = is_prefix ? 1 : edit_distance(word, candidate);
    if (distance < best_distance && distance < candidate.size()) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

Options::Options(std::string command, std::string summary, std::string example)
    : isa(best_isa()), command_(std::move(command)), summary_(std::move(summary)), example_(std::move(example)) {
  add_common();
}

void Options::add_common() {
  flag("--json", json, "one JSON object on stdout and nothing else there");
  flag("--quiet", quiet, "no progress, no messages but errors");
  integer("--threads", "N", threads, 0, 1024, "0 = all processors; results never depend on it");
  add("--isa", "NAME", "scalar, sse41, avx2 or neon; also PAC_ISA; results never depend on it").set =
      [this](const std::string& name) { return set_isa(name); };
  flag("--help", help_, "this text");
  for (Option& option : options_) option.is_common = true;
}

std::string Options::set_isa(const std::string& name) {
  if (!parse_isa(name, isa)) return "'" + name + "' is not one of scalar, sse41, avx2, neon";
  if (!isa_is_built(isa)) return name + " is not in this build";
  if (!isa_is_supported(isa)) return "this processor does not have " + name;
  return "";
}

Options::Option& Options::add(const char* names, const char* meta, const char* help) {
  Option option;
  const std::string_view text(names);
  const size_t bar = text.find('|');
  if (bar != std::string_view::npos) {
    option.short_name = text.substr(0, bar);
    option.long_name = text.substr(bar + 1);
  } else {
    (text.starts_with("--") ? option.long_name : option.short_name) = text;
  }
  option.meta = meta;
  option.help = help;
  option.takes_value = *meta != 0;
  options_.push_back(std::move(option));
  return options_.back();
}

void Options::positional(const char* meta, std::string& target, const char* help) {
  positionals_.push_back({meta, help, &target});
}

void Options::positionals(const char* meta, std::vector<std::string>& targets, const char* help) {
  positionals_.push_back({meta, help, nullptr, &targets});
}

void Options::flag(const char* names, bool& target, const char* help) {
  add(names, "", help).set = [&target](const std::string&) {
    target = true;
    return std::string();
  };
}

void Options::text(const char* names, const char* meta, std::string& target, const char* help, bool required) {
  Option& option = add(names, meta, help);
  option.required = required;
  option.set = [&target](const std::string& value) {
    target = value;
    return value.empty() ? std::string("needs a value that is not empty") : std::string();
  };
}

void Options::integer(const char* names, const char* meta, int& target, int least, int most, const char* help) {
  Option& option = add(names, meta, help);
  option.set = [&target, least, most](const std::string& value) {
    int number = 0;
    if (!parse_number(value, number) || number < least || number > most)
      return "'" + value + "' is not a whole number in " + std::to_string(least) + ".." + std::to_string(most);
    target = number;
    return std::string();
  };
}

void Options::real(const char* names, const char* meta, double& target, double least, double most, const char* help) {
  Option& option = add(names, meta, help);
  option.set = [&target, least, most](const std::string& value) {
    double number = 0;
    if (!parse_number(value, number) || !(number >= least && number <= most))
      return "'" + value + "' is not a number in " + range_text(least, most);
    target = number;
    return std::string();
  };
}

void Options::reals(const char* names, const char* meta, std::vector<double>& targets, double least, double most,
                    const char* help) {
  Option& option = add(names, meta, help);
  option.set = [&targets, least, most](const std::string& value) {
    std::vector<double> numbers;
    for (size_t begin = 0; begin <= value.size();) {
      const size_t end = std::min(value.find(',', begin), value.size());
      const std::string word = value.substr(begin, end - begin);
      double number = 0;
      if (!parse_number(word, number) || !(number >= least && number <= most))
        return "'" + word + "' is not a number in " + range_text(least, most);
      if (std::find(numbers.begin(), numbers.end(), number) != numbers.end()) return "'" + word + "' is there twice";
      numbers.push_back(number);
      begin = end + 1;
    }
    targets = std::move(numbers);
    return std::string();
  };
}

void Options::add_choice(const char* names, std::vector<std::string> labels, const char* help,
                         std::function<void(size_t)> set) {
  std::string meta, list;
  for (const std::string& label : labels) {
    meta += (meta.empty() ? "" : "|") + label;
    list += (list.empty() ? "" : ", ") + label;
  }
  add(names, meta.c_str(), help).set = [labels, list, set](const std::string& value) {
    for (size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == value) {
        set(i);
        return std::string();
      }
    const std::string suggestion = nearest(value, labels);
    return "'" + value + "' is not one of " + list + (suggestion.empty() ? "" : "; did you mean '" + suggestion + "'?");
  };
}

Options::Option* Options::find(std::string_view name) {
  for (Option& option : options_)
    if (!name.empty() && (name == option.long_name || name == option.short_name)) return &option;
  return nullptr;
}

bool Options::given(std::string_view name) const {
  for (const Option& option : options_)
    if (name == option.long_name || name == option.short_name) return option.given;
  return false;
}

std::string Options::nearest_option(std::string_view name) const {
  std::vector<std::string> names;
  for (const Option& option : options_)
    names.push_back(option.long_name.empty() ? option.short_name : option.long_name);
  return nearest(name, names);
}

// argument: "--name", "--name=value", "-x" or "-xvalue"; takes the value from args[next] where it has none.
std::string Options::parse_option(const std::string& argument, Args args, size_t& next) {
  const size_t equals = argument.find('=');
  const bool is_long = argument.starts_with("--");
  std::string name = is_long ? argument.substr(0, equals) : argument.substr(0, 2);
  std::optional<std::string> value;
  if (is_long && equals != std::string::npos) value = argument.substr(equals + 1);
  if (!is_long && argument.size() > 2) value = argument.substr(argument[2] == '=' ? 3 : 2);

  Option* option = find(name);
  if (option == nullptr) {
    if (!is_long) name = argument.substr(0, equals);
    const std::string suggestion = nearest_option(name);
    return "unknown option " + name + (suggestion.empty() ? "" : "; did you mean " + suggestion + "?");
  }
  if (!option->takes_value && value) return name + " takes no value";
  if (option->takes_value && !value) {
    if (next >= args.size() || std::string_view(args[next]).starts_with("--"))
      return name + " needs a value: " + option->meta;
    value = args[next++];
  }
  option->given = true;
  const std::string problem = option->set(value.value_or(""));
  return problem.empty() ? "" : name + ": " + problem;
}

std::string Options::check_complete(size_t n_positionals) const {
  if (n_positionals < positionals_.size()) return "missing " + positionals_[n_positionals].meta;
  for (const Option& option : options_)
    if (option.required && !option.given) return "missing " + option.short_name + " " + option.meta;
  return "";
}

std::optional<int> Options::parse(Args args) {
  for (const char* argument : args) {
    if (std::string_view(argument) == "--") break;
    if (std::string_view(argument) == "--help" || std::string_view(argument) == "-h") {
      print_help();
      return 0;
    }
  }
  if (const char* name = std::getenv("PAC_ISA"); name != nullptr && *name != 0)
    if (const std::string problem = set_isa(name); !problem.empty()) return usage_error("PAC_ISA: " + problem);

  size_t n_positionals = 0;
  bool only_positionals = false;
  for (size_t next = 0; next < args.size();) {
    const std::string argument = args[next++];
    std::string problem;
    if (!only_positionals && argument == "--") {
      only_positionals = true;
    } else if (!only_positionals && argument.size() > 1 && argument[0] == '-') {
      problem = parse_option(argument, args, next);
    } else if (n_positionals < positionals_.size() && positionals_[n_positionals].target != nullptr) {
      *positionals_[n_positionals++].target = argument;
    } else if (!positionals_.empty() && positionals_.back().targets != nullptr) {
      positionals_.back().targets->push_back(argument);
      n_positionals = positionals_.size();
    } else {
      problem = "unexpected argument '" + argument + "'";
    }
    if (!problem.empty()) return usage_error(problem);
  }
  if (const std::string problem = check_complete(n_positionals); !problem.empty()) return usage_error(problem);
  if (threads == 0) threads = hardware_thread_count();
  return std::nullopt;
}

int Options::usage_error(const std::string& problem) const {
  std::fprintf(stderr, "pac %s: %s\nusage: %s\n'pac %s --help' says more\n", command_.c_str(), problem.c_str(),
               usage_line().c_str(), command_.c_str());
  return 2;
}

std::string Options::usage_line() const {
  std::string line = "pac " + command_;
  for (const Positional& operand : positionals_) line += " " + operand.meta;
  for (const Option& option : options_)
    if (option.required) line += " " + option.short_name + " " + option.meta;
  return line + " [options]";
}

void Options::print_help() const {
  constexpr int kColumn = 30;
  const auto print_row = [](const std::string& left, const std::string& right) {
    if (left.size() + 4 > kColumn)
      std::printf("  %s\n%*s%s\n", left.c_str(), kColumn, "", right.c_str());
    else
      std::printf("  %-*s%s\n", kColumn - 2, left.c_str(), right.c_str());
  };
  std::printf("pac %s: %s\n\nusage: %s\n", command_.c_str(), summary_.c_str(), usage_line().c_str());
  for (const Positional& operand : positionals_) print_row(operand.meta, operand.help);
  for (const bool common : {false, true}) {
    if (common || options_.back().is_common == common) std::printf("%s", common ? "\nevery command:\n" : "\n");
    for (const Option& option : options_) {
      if (option.is_common != common) continue;
      const bool both = !option.short_name.empty() && !option.long_name.empty();
      const std::string names = option.short_name + (both ? ", " : "") + option.long_name;
      print_row(names + (option.meta.empty() ? "" : " " + option.meta), option.help);
    }
  }
  std::printf("\nexample:\n  %s\n", example_.c_str());
}

}  // namespace pac::cli
