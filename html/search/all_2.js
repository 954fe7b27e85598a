var searchData=
[
  ['the_20engines_20beside_20the_20truth_0',['The engines beside the truth',['../md_ENGINES.html',1,'']]]
];
