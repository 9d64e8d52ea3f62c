// results.h: reading numbers from the documents of test results.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "io/document.h"

namespace kiln::analyze {

/// The errors of all of these are for cli::for_each_document to put the document before.

/// Throws Error "is X, TOOL reads Y" unless the document has one of the wanted formats in a version that is known.
void expect_format(const io::Document& document, std::initializer_list<const char*> wanted, const std::string& tool);

/// The finite number at a key of the header, at least `lowest`; throws Error naming the key.
double number_at(const io::Document& document, const std::string& key, double lowest);

/// The same, greater than zero.
double positive_at(const io::Document& document, const std::string& key);

/// The list of finite numbers at header[object][key]; throws Error naming the key.
std::vector<double> numbers_at(const io::Document& document, const std::string& object, const std::string& key);

/// The sentences of the document's "warnings", none where it has no such key. Throws Error where they are no list of sentences.
std::vector<std::string> warnings_at(const io::Document& document);

/// The different "material" of objects in one text, in the order in which they come; null where none has one.
Json joined_materials(const std::vector<Json>& objects);

}  // namespace kiln::analyze
