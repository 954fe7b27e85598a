var indexSectionsWithContent =
{
  0: "cht",
  1: "cht"
};

var indexSectionNames =
{
  0: "all",
  1: "pages"
};

var indexSectionLabels =
{
  0: "All",
  1: "Pages"
};

