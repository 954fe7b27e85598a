var searchData=
[
  ['contributing_0',['Contributing',['../md_CONTRIBUTING.html',1,'']]]
];
