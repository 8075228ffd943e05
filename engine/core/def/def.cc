#include "engine/core/def/def.h"

#include <algorithm>
#include <stdexcept>

namespace truestep {

const ParamRow* DefTable::find(std::string_view name) const {
  for (const ParamRow& r : rows) {
    if (r.name == name || std::find(r.also.begin(), r.also.end(), name) != r.also.end()) return &r;
  }
  return nullptr;
}

TableBuilder::TableBuilder(const char* sentence, void* (*make)(), void (*end)(void* owner)) {
  table_.sentence = sentence;
  table_.make = [=] { return std::shared_ptr<void>(make(), end); };
}

ParamRow& TableBuilder::row(ParamKind kind, const Words& words, Limits limits) {
  ParamRow& r = table_.rows.emplace_back();
  r.kind = kind, r.name = words.name, r.unit = words.unit, r.limits = limits, r.sentence = words.sentence;
  return r;
}

ParamRow& TableBuilder::value(ParamKind kind, const Words& words, size_t offset, ValueAccess access,
                              Limits limits) {
  ParamRow& r = row(kind, words, limits);
  r.set = [=](void* o, ParamValue v) { access.set(static_cast<char*>(o) + offset, std::move(v)); };
  r.get = [=](const void* o) { return access.get(static_cast<const char*>(o) + offset); };
  return r;
}

void TableBuilder::choice(const Words& words, size_t offset, ChoiceAccess access,
                          std::initializer_list<const char*> choices) {
  choice(words, offset, access, std::vector<std::string>(choices.begin(), choices.end()));
}

void TableBuilder::choice(const Words& words, size_t offset, ChoiceAccess access,
                          const std::vector<std::string>& choices) {
  ParamRow& r = row(ParamKind::choice, words, any());
  // "a|b": b is read as a synonym of a, which is the form written.
  std::vector<size_t> meant;
  for (size_t k = 0; k < choices.size(); ++k) r.choices.push_back(first_word(choices[k])), meant.push_back(k);
  for (size_t k = 0; k < choices.size(); ++k) {
    for (std::string& other : other_words(choices[k]))
      r.choices.push_back(std::move(other)), meant.push_back(k);
  }
  r.set = [=, all = r.choices](void* o, ParamValue v) {
    const auto found = std::find(all.begin(), all.end(), std::get<std::string>(v));
    if (found == all.end()) return;
    access.set(static_cast<char*>(o) + offset, meant[static_cast<size_t>(found - all.begin())]);
  };
  r.get = [=](const void* o) {
    return ParamValue(first_word(choices[access.get(static_cast<const char*>(o) + offset)]));
  };
}

ParamRow& TableBuilder::nested(ParamKind kind, const Words& words, size_t offset, NestedAccess access,
                               const DefTable* nested) {
  ParamRow& r = row(kind, words, any());
  r.nested = nested;
  r.append = [=](void* o) { return access.append(static_cast<char*>(o) + offset); };
  r.size = [=](const void* o) { return access.size(static_cast<const char*>(o) + offset); };
  r.at = [=](const void* o, size_t i) { return access.at(static_cast<const char*>(o) + offset, i); };
  return r;
}

void TableBuilder::variants(const Words& words, size_t offset, size_t (*size)(const void* member),
                            Count count) {
  ParamRow& r = row(ParamKind::variants, words, any());
  r.count = count;
  r.size = [=](const void* o) { return size(static_cast<const char*>(o) + offset); };
}

void TableBuilder::variant(const NamedTable& named, size_t offset, VariantAccess access) {
  table_.rows.back().variants.push_back(
      {first_word(named.words), other_words(named.words), named.table,
       [=](void* o) { return access.append(static_cast<char*>(o) + offset); },
       [=](const void* o, size_t i) { return access.at(static_cast<const char*>(o) + offset, i); }});
}

void TableBuilder::append(const DefTable& base, size_t offset) {
  if (offset != 0) throw std::logic_error("a struct must begin with the base whose rows it takes");
  table_.rows.insert(table_.rows.end(), base.rows.begin(), base.rows.end());
}

void TableBuilder::set_required() {
  table_.rows.back().presence = Presence::required;
}

void TableBuilder::add_synonym(const char* word) {
  table_.rows.back().also.emplace_back(word);
}

std::string first_word(const std::string& words) {
  return words.substr(0, words.find('|'));
}

std::vector<std::string> other_words(const std::string& words) {
  std::vector<std::string> others;
  for (size_t bar = words.find('|'); bar != std::string::npos;) {
    const size_t next = words.find('|', bar + 1);
    others.push_back(words.substr(bar + 1, next - bar - 1));
    bar = next;
  }
  return others;
}

}  // namespace truestep
